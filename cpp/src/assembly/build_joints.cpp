/// How joints, gears and drive trains become constraints, scalar coordinates and laws between them.
#include "flexarm/assembly/system.hpp"
#include "flexarm/errors.hpp"

namespace flexarm::assembly {

using namespace geometry;
using joints::JointType;

namespace {

/// Of the spring of a hinge that follows a table [N m/rad].
constexpr double nearly_rigid = 1e9;

}  // namespace

void System::place_scalars(const std::map<std::string, DriveKind>& drives) {
  for (const auto& [name, kind] : drives) joint_index(name);

  // Scalar coordinates: first collected in the order of the joints, then the free ones are put before the
  // others.
  struct Scalar {
    double inertia;
    bool free;
  };
  std::vector<Scalar> scalars;
  for (const model::Joint& joint : arm_.joints) {
    const auto found = drives.find(joint.name);
    const DriveKind kind = found == drives.end() ? DriveKind::locked : found->second;
    const bool moves = joint.type == JointType::revolute || joint.type == JointType::prismatic;
    if (!moves && kind != DriveKind::locked) {
      throw InvalidParameter("joint '" + joint.name + "': only a revolute or prismatic joint can be driven");
    }
    drives_.push_back(kind);
    JointCoordinates at;
    if (moves) {
      const bool driven = kind != DriveKind::torque && kind != DriveKind::free;
      const auto& train = joint.drive_train;
      const bool rigid = train.stages.empty() || kind == DriveKind::link_angle;
      const auto add_scalar = [&](double inertia, bool free) {
        scalars.push_back({inertia, free});
        return static_cast<int>(scalars.size()) - 1;
      };
      at.phi = add_scalar(train.reflected_inertia(), !driven);
      at.psi = train.transmission ? add_scalar(0, true) : at.phi;
      int before = at.psi;
      const std::size_t first_law = laws_.size();
      if (!rigid) {
        for (const auto& stage : train.stages) {
          const int after = add_scalar(0, true);
          for (const auto& law : stage) laws_.push_back({law, before, after});
          before = after;
        }
      }
      at.theta = before;
      for (const auto& law : train.motor) laws_.push_back({law, at.phi, -1});
      for (const auto& law : train.bearing) laws_.push_back({law, at.theta, -1});
      for (std::size_t k = first_law; k < laws_.size(); ++k) {
        const joints::Of of = joints::second_argument(laws_[k].law);
        if (of != joints::Of::torque) laws_[k].of = of == joints::Of::angle ? at.theta : at.phi;
      }
    }
    joint_coordinates_.push_back(at);
  }
  std::size_t next = 0;
  for (const auto& chain : hinge_chains()) {
    for (const model::Hinge& hinge : chain) {
      HingeCoordinates& at = hinges_[next++];
      at.theta = static_cast<int>(scalars.size());
      scalars.push_back({0, true});
      if (hinge.follows) {
        const PlacedTable y = placed(*hinge.follows);
        const joints::WoundSpring spring{
            {nearly_rigid}, y.of_rate ? joints::Of::rate : joints::Of::angle, y.table};
        laws_.push_back({spring, at.theta, -1, y.scalar});
        continue;
      }
      if (hinge.laws.empty())
        laws_.push_back({joints::ReducerSpring{hinge.stiffness, hinge.damping}, at.theta, -1});
      for (const auto& law : hinge.laws) {
        const joints::Of of = joints::second_argument(law);
        const auto* pin = std::get_if<joints::RadialClearance>(&law);
        const int other = pin != nullptr ? at.theta + pin->across : at.theta;  // one coordinate a hinge
        laws_.push_back({law, at.theta, -1, of == joints::Of::torque ? -1 : other});
      }
    }
  }
  for (const PlacedLaw& law : laws_) joints::check(law.law);

  std::vector<int> order(scalars.size());
  for (bool free : {true, false}) {
    for (std::size_t k = 0; k < scalars.size(); ++k) {
      if (scalars[k].free != free) continue;
      order[k] = static_cast<int>(scalar_inertia_.size());
      scalar_inertia_.push_back(scalars[k].inertia);
    }
    if (free) {
      place_superelements();
      n_free_scalars_ = static_cast<int>(scalar_inertia_.size());
    }
  }
  const auto ordered = [&](int k) { return k < 0 ? k : order[k]; };
  for (JointCoordinates& at : joint_coordinates_) at = {ordered(at.theta), ordered(at.phi), ordered(at.psi)};
  for (HingeCoordinates& at : hinges_) at.theta = ordered(at.theta);
  for (PlacedLaw& law : laws_) law = {law.law, ordered(law.plus), ordered(law.minus), ordered(law.of)};
}

/// The amplitudes of their modes are free scalar coordinates without inertia of their own.
void System::place_superelements() {
  for (std::size_t k = 0; k < arm_.links.size(); ++k) {
    const auto* part = std::get_if<model::SuperElementLink>(&arm_.links[k]);
    if (part == nullptr) continue;
    superelements_.emplace_back(*part, meshes_[k].first_node, static_cast<int>(scalar_inertia_.size()));
    scalar_inertia_.resize(scalar_inertia_.size() + superelements_.back().n_modes(), 0.0);
  }
}

/// Of the pedestal first, then of every joint, then of every closure.
std::vector<std::vector<model::Hinge>> System::hinge_chains() const {
  std::vector<std::vector<model::Hinge>> chains;
  if (arm_.pedestal) chains.push_back(arm_.pedestal->hinges);
  for (const model::Joint& joint : arm_.joints) chains.push_back(joint.mount);
  for (const model::Closure& closure : arm_.closures) chains.push_back(closure.hinges());
  return chains;
}

int System::carry(const std::vector<model::Hinge>& chain, std::size_t first_hinge, int node, Frame X,
                  std::vector<joints::JointConstraint>& into) const {
  for (const model::Hinge& hinge : chain) {
    const HingeCoordinates& at = hinges_[first_hinge++];
    into.emplace_back(hinge.type, node, X, at.node, Frame{}, hinge.axis, at.theta);
    node = at.node;
    X = Frame{};
  }
  return node;
}

void System::place_joints() {
  std::vector<joints::JointConstraint> of_hinges;
  if (arm_.pedestal) {
    pedestal_.node = carry(arm_.pedestal->hinges, 0, joints::JointConstraint::ground, Frame{}, of_hinges);
    pedestal_.shaking = *arm_.pedestal;
    for (std::size_t k = 0; k < of_hinges.size(); ++k) {
      pedestal_.thetas.push_back(hinges_[k].theta);
      pedestal_.cosines.push_back(
          arm_.pedestal->hinges[k].axis.normalized().dot(arm_.pedestal->axis.normalized()));
    }
  }
  for (std::size_t k = 0; k < arm_.joints.size(); ++k) {
    const model::Joint& joint = arm_.joints[k];
    const Place child = place(joint.child);
    int node_a = pedestal_.node;
    Frame X_a = joint.origin;
    if (joint.parent != "base") {
      const Place parent = place(joint.parent, joint.at_end);
      node_a = node(parent);
      X_a = axes(parent) * joint.origin;
    }
    reach_ += joint.origin.x.norm();
    if (!joint.mount.empty()) {
      node_a = carry(joint.mount, of_hinges.size(), node_a, X_a, of_hinges);
      X_a = Frame{};
    }
    constraints_.emplace_back(joint.type, node_a, X_a, node(child), axes(child), joint.axis,
                              joint_coordinates_[k].theta);
  }
  constraints_.insert(constraints_.end(), of_hinges.begin(), of_hinges.end());
  for (const joints::JointConstraint& constraint : constraints_) n_constraints_ += constraint.rows();
}

void System::place_gears() {
  for (const model::Gear& gear : arm_.gears) {
    const int in = joint_coordinates_[joint_index(gear.input)].theta;
    const int out = joint_coordinates_[joint_index(gear.output)].phi;
    if (in < 0 || out < 0) throw InvalidParameter("gear '" + gear.name + "': both joints must turn or slide");
    if (!is_free(in) && !is_free(out)) {
      throw InvalidParameter("gear '" + gear.name +
                             "': input and output are both driven rigidly; drive one of them");
    }
    if (gear.ratio == 0) throw InvalidParameter("gear '" + gear.name + "': ratio must not be zero");
    gears_.push_back({in, out, {.scale = gear.ratio}});
    ++n_constraints_;
  }
}

void System::place_transmissions() {
  for (std::size_t k = 0; k < arm_.joints.size(); ++k) {
    const model::Joint& joint = arm_.joints[k];
    const auto& train = joint.drive_train;
    if (!train.transmission || joint_coordinates_[k].phi < 0) continue;
    double motor_turns = train.gear_ratio;  // per turn of φ
    for (const model::Gear& gear : arm_.gears) {
      if (gear.output == joint.name) motor_turns *= gear.ratio;
    }
    const joints::Transmission psi = train.transmission->geared(motor_turns);
    try {
      psi.check();
    } catch (const InvalidParameter& mistake) {
      throw InvalidParameter("joint '" + joint.name + "': " + mistake.what());
    }
    gears_.push_back({joint_coordinates_[k].phi, joint_coordinates_[k].psi, psi});
    ++n_constraints_;
  }
}

}  // namespace flexarm::assembly
