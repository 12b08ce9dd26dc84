#include "flexarm/assembly/system.hpp"

#include <algorithm>
#include <cmath>

#include "flexarm/elements/clamped_mode.hpp"
#include "flexarm/errors.hpp"

namespace flexarm::assembly {
namespace {

using namespace geometry;
using joints::JointType;

const Frame base_frame;

template <class Things>
std::string names_of(const Things& things) {
  std::string all;
  for (const auto& thing : things) all += (all.empty() ? "" : ", ") + thing.name;
  return all.empty() ? "none" : all;
}

template <class Things>
int index_of(const Things& things, const std::string& name, const std::string& what) {
  for (std::size_t k = 0; k < things.size(); ++k) {
    if (things[k].name == name) return static_cast<int>(k);
  }
  throw InvalidParameter("there is no " + what + " '" + name + "'; there are: " + names_of(things));
}

}  // namespace

int System::joint_index(const std::string& name) const { return index_of(arm_.joints, name, "joint"); }
int System::point_index(const std::string& name) const { return index_of(arm_.points, name, "point"); }

int System::link_index(const std::string& name) const {
  for (std::size_t k = 0; k < arm_.links.size(); ++k) {
    if (model::name_of(arm_.links[k]) == name) return static_cast<int>(k);
  }
  throw InvalidParameter("there is no link '" + name + "'");
}

const Attachment& System::loaded_point(int point) const {
  if (point < 0 || point >= static_cast<int>(points_.size()) || points_[point].element >= 0) {
    throw InvalidParameter("a point load needs a point of the arm that is declared as loaded, got number " +
                           std::to_string(point));
  }
  return points_[point];
}

const Frame& System::frame(const State& state, int node) const {
  return node < 0 ? base_frame : state.frames[node];
}

System::System(const model::Arm& arm, const std::map<std::string, DriveKind>& drives) : arm_(arm) {
  std::vector<std::vector<double>> occupied(arm_.links.size());
  const auto occupy = [&](const std::string& link, const Vector3d& position) {
    const int k = link_index(link);
    if (const auto* beam = std::get_if<model::BeamLink>(&arm_.links[k])) {
      const double L = beam->end.norm();
      occupied[k].push_back(std::clamp(beam->end.dot(position) / L, 0.0, L));
    }
  };
  for (const model::Payload& payload : arm_.payloads) occupy(payload.link, payload.position);
  for (const model::Point& point : arm_.points) {
    if (point.loaded) occupy(point.link, point.position);
  }
  mesh_links(occupied);
  place_joints(drives);
  place_masses();
  set_damping();
  for (const model::Point& point : arm_.points) {
    points_.push_back(attach(meshes_[link_index(point.link)], point.position, point.loaded));
  }
}

void System::mesh_links(const std::vector<std::vector<double>>& occupied) {
  for (std::size_t k = 0; k < arm_.links.size(); ++k) {
    LinkMesh mesh;
    mesh.first_node = n_nodes_;
    mesh.first_element = static_cast<int>(beams_.size());
    if (const auto* beam = std::get_if<model::BeamLink>(&arm_.links[k])) {
      if (!(beam->end.norm() > 0))
        throw InvalidParameter("link '" + beam->name + "': `end` must not be the origin");
      if (beam->elements < 1) {
        throw InvalidParameter("link '" + beam->name + "': elements must be at least 1, got " +
                               std::to_string(beam->elements));
      }
      beam->section.check();
      beam->material.check();
      mesh.R_LS = section_axes(beam->end, beam->up);
      mesh.stations = beam_stations(beam->end.norm(), beam->elements, occupied[k]);
      const auto properties = elements::BeamProperties::from(*beam);
      for (int e = 0; e + 1 < mesh.n_nodes(); ++e) {
        beams_.emplace_back(n_nodes_ + e, n_nodes_ + e + 1, mesh.node_frame(base_frame, e),
                            mesh.node_frame(base_frame, e + 1), properties);
      }
      reach_ += beam->end.norm();
    }
    n_nodes_ += mesh.n_nodes();
    meshes_.push_back(mesh);
  }
}

void System::place_joints(const std::map<std::string, DriveKind>& drives) {
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
    drives_.push_back(kind);
    JointCoordinates at;
    if (joint.type == JointType::revolute || joint.type == JointType::prismatic) {
      const bool driven = kind != DriveKind::torque && kind != DriveKind::free;
      const auto& train = joint.drive_train;
      const bool rigid = train.stages.empty() || kind == DriveKind::link_angle;
      const auto add_scalar = [&](double inertia, bool free) {
        scalars.push_back({inertia, free});
        return static_cast<int>(scalars.size()) - 1;
      };
      at.phi = add_scalar(train.reflected_inertia(), !driven);
      int before = at.phi;
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
    }
    joint_coordinates_.push_back(at);
  }
  for (const PlacedLaw& law : laws_) joints::check(law.law);

  std::vector<int> order(scalars.size());
  for (bool free : {true, false}) {
    for (std::size_t k = 0; k < scalars.size(); ++k) {
      if (scalars[k].free != free) continue;
      order[k] = static_cast<int>(scalar_inertia_.size());
      scalar_inertia_.push_back(scalars[k].inertia);
    }
    if (free) n_free_scalars_ = static_cast<int>(scalar_inertia_.size());
  }
  const auto place = [&](int k) { return k < 0 ? k : order[k]; };
  for (JointCoordinates& at : joint_coordinates_) at = {place(at.theta), place(at.phi)};
  for (PlacedLaw& law : laws_) law = {law.law, place(law.plus), place(law.minus)};

  for (std::size_t k = 0; k < arm_.joints.size(); ++k) {
    const model::Joint& joint = arm_.joints[k];
    const LinkMesh& child = meshes_[link_index(joint.child)];
    int node_a = joints::JointConstraint::ground;
    Frame X_a = joint.origin;
    if (joint.parent != "base") {
      const LinkMesh& parent = meshes_[link_index(joint.parent)];
      node_a = joint.at_end ? parent.last_node() : parent.first_node;
      X_a = parent.link_axes() * joint.origin;
    }
    reach_ += joint.origin.x.norm();
    constraints_.emplace_back(joint.type, node_a, X_a, child.first_node, child.link_axes(), joint.axis,
                              joint_coordinates_[k].theta);
    n_constraints_ += constraints_.back().rows();
  }
  for (const model::Gear& gear : arm_.gears) {
    const int in = joint_coordinates_[joint_index(gear.input)].theta;
    const int out = joint_coordinates_[joint_index(gear.output)].phi;
    if (in < 0 || out < 0) throw InvalidParameter("gear '" + gear.name + "': both joints must turn or slide");
    if (!is_free(in) && !is_free(out)) {
      throw InvalidParameter("gear '" + gear.name +
                             "': input and output are both driven rigidly; drive one of them");
    }
    gears_.push_back({in, out, gear.ratio});
    ++n_constraints_;
  }
}

void System::place_masses() {
  weights_.resize(n_nodes_);
  for (const elements::BeamElement& beam : beams_) {
    const Vector3d along = Vector3d::UnitX() * beam.end_moment();
    weights_[beam.node1()].mass += beam.end_mass();
    weights_[beam.node1()].moment += along;
    weights_[beam.node2()].mass += beam.end_mass();
    weights_[beam.node2()].moment -= along;
  }
  std::map<int, elements::RigidBody> at_node;
  const auto add = [&](const Attachment& at, double mass, const Vector3d& com, const Matrix3d& inertia) {
    const Vector3d c = at.offset * com;
    at_node.try_emplace(at.node, at.node)
        .first->second.add(mass, c, at.offset.R * inertia * at.offset.R.transpose());
    weights_[at.node].mass += mass;
    weights_[at.node].moment += mass * c;
  };
  for (std::size_t k = 0; k < arm_.links.size(); ++k) {
    if (const auto* body = std::get_if<model::RigidLink>(&arm_.links[k])) {
      add(attach(meshes_[k], Vector3d::Zero(), true), body->mass, body->com, body->inertia);
      reach_ += body->com.norm();
    }
  }
  for (const model::Payload& payload : arm_.payloads) {
    add(attach(meshes_[link_index(payload.link)], payload.position, true), payload.mass, payload.offset,
        payload.inertia);
  }
  for (const auto& [node, body] : at_node) bodies_.push_back(body);
  for (const elements::Weight& weight : weights_) mass_ += weight.mass;
  if (!(reach_ > 0)) reach_ = 1;
}

void System::set_damping() {
  for (std::size_t k = 0; k < arm_.links.size(); ++k) {
    const auto* beam = std::get_if<model::BeamLink>(&arm_.links[k]);
    if (beam == nullptr || beam->damping_ratio == 0) continue;
    if (!(beam->damping_ratio > 0 && beam->material.density > 0)) {
      throw InvalidParameter("link '" + beam->name +
                             "': a damping ratio must be positive and needs mass to act on, got " +
                             std::to_string(beam->damping_ratio) + " at a density of " +
                             std::to_string(beam->material.density) + " kg/m³");
    }
    const LinkMesh& mesh = meshes_[k];
    const double omega =
        elements::first_clamped_frequency(std::span(beams_).subspan(mesh.first_element, mesh.n_nodes() - 1));
    for (int e = 0; e + 1 < mesh.n_nodes(); ++e) {
      beams_[mesh.first_element + e].set_damping_time(2 * beam->damping_ratio / omega);
    }
  }
}

State System::rigid_state(const std::vector<double>& joint_values) const {
  if (joint_values.size() != arm_.joints.size()) {
    throw InvalidParameter("one value for each of the " + std::to_string(arm_.joints.size()) +
                           " joints is needed, got " + std::to_string(joint_values.size()));
  }
  State state;
  state.frames.resize(n_nodes_);
  state.s = VectorXd::Zero(n_scalars());
  state.v = state.v_dot = state.a = VectorXd::Zero(n_velocities());
  state.multipliers = VectorXd::Zero(n_constraints_);
  state.laws.resize(laws_.size());

  std::vector<bool> placed(arm_.links.size(), false);
  for (bool progress = true; progress;) {
    progress = false;
    for (std::size_t k = 0; k < arm_.joints.size(); ++k) {
      const model::Joint& joint = arm_.joints[k];
      const int child = link_index(joint.child);
      if (placed[child]) continue;
      Frame A = joint.origin;
      if (joint.parent != "base") {
        const int parent = link_index(joint.parent);
        if (!placed[parent]) continue;
        const LinkMesh& mesh = meshes_[parent];
        const int node = joint.at_end ? mesh.last_node() : mesh.first_node;
        A = state.frames[node] * mesh.link_axes() * joint.origin;
      }
      const Frame B = A * exp6(joint_values[k] * joints::motion_twist(joint.type, joint.axis));
      const LinkMesh& mesh = meshes_[child];
      for (int n = 0; n < mesh.n_nodes(); ++n) state.frames[mesh.first_node + n] = mesh.node_frame(B, n);
      placed[child] = progress = true;
    }
  }
  for (std::size_t k = 0; k < placed.size(); ++k) {
    if (!placed[k])
      throw InvalidParameter("link '" + model::name_of(arm_.links[k]) +
                             "' is not connected to the base by joints");
  }
  for (std::size_t k = 0; k < arm_.joints.size(); ++k) {
    const JointCoordinates& at = joint_coordinates_[k];
    if (at.phi < 0) continue;
    state.s[at.phi] = state.s[at.theta] = joint_values[k];
  }
  for (const PlacedLaw& law : laws_) {  // stages are listed from motor to link: no deflection in any
    if (law.minus >= 0) state.s[law.minus] = state.s[law.plus];
  }
  remember(state);
  return state;
}

void System::remember(State& state) const {
  for (std::size_t k = 0; k < laws_.size(); ++k) state.laws[k].x = deflection(laws_[k], state.s);
}

void System::residual(const State& state, const Loads& loads, bool friction, VectorXd& r) const {
  r.setZero();
  for (const elements::BeamElement& beam : beams_) {
    const int n1 = 6 * beam.node1(), n2 = 6 * beam.node2();
    elements::Vector12d v, v_dot;
    v << state.v.segment<6>(n1), state.v.segment<6>(n2);
    v_dot << state.v_dot.segment<6>(n1), state.v_dot.segment<6>(n2);
    const auto f = beam.internal_forces(state.frames[beam.node1()], state.frames[beam.node2()], v.head<6>(),
                                        v.tail<6>());
    const elements::Vector12d inertia = beam.inertia_forces(v, v_dot);
    r.segment<6>(n1) += f.f1 + inertia.head<6>();
    r.segment<6>(n2) += f.f2 + inertia.tail<6>();
  }
  for (const elements::RigidBody& body : bodies_) {
    const int n = 6 * body.node();
    r.segment<6>(n) += body.inertia_forces(state.v.segment<6>(n), state.v_dot.segment<6>(n));
  }
  for (int n = 0; n < n_nodes_; ++n)
    r.segment<6>(6 * n) -= weights_[n].force(state.frames[n].R, loads.gravity);
  for (const PointLoad& load : loads.points) {
    const Attachment& at = loaded_point(load.point);
    const Matrix3d to_node = load.follows ? at.offset.R : Matrix3d(state.frames[at.node].R.transpose());
    const Vector3d force = to_node * load.force;
    r.segment<3>(6 * at.node) -= force;
    r.segment<3>(6 * at.node + 3) -= to_node * load.moment + at.offset.x.cross(force);
  }

  int row = 0;
  for (const joints::JointConstraint& joint : constraints_) {
    const int a = joint.node_a(), b = joint.node_b(), q = joint.coordinate(), m = joint.rows();
    Vector6d lambda = Vector6d::Zero();
    lambda.head(m) = state.multipliers.segment(row, m);
    const auto f = joint.forces(frame(state, a), frame(state, b), q < 0 ? 0.0 : state.s[q], lambda);
    r.segment<6>(6 * b) += f.b;
    if (a >= 0) r.segment<6>(6 * a) += f.a;
    row += m;
  }
  scalar_residual(state, friction, r.tail(n_scalars()));
  if (loads.torques.size() > 0) r.tail(n_scalars()) -= loads.torques;
}

void System::scalar_residual(const State& state, bool friction, Eigen::Ref<VectorXd> r) const {
  for (int k = 0; k < n_scalars(); ++k) r[k] = scalar_inertia_[k] * state.v_dot[scalar_offset() + k];
  for (std::size_t k = 0; k < laws_.size(); ++k) {
    const PlacedLaw& law = laws_[k];
    if (!friction && !joints::acts_at_rest(law.law)) continue;
    const double rate = deflection(law, state.v.tail(n_scalars()));
    const double force = joints::respond(law.law, deflection(law, state.s), rate, state.laws[k]).force;
    r[law.plus] += force;
    if (law.minus >= 0) r[law.minus] -= force;
  }
  int row = 0;
  for (const joints::JointConstraint& joint : constraints_) {
    const int q = joint.coordinate();
    if (q >= 0) r[q] -= joint.twist().dot(state.multipliers.segment<6>(row));
    row += joint.rows();
  }
  for (const GearConstraint& gear : gears_) {
    r[gear.input] += state.multipliers[row];
    r[gear.output] -= gear.ratio * state.multipliers[row];
    ++row;
  }
}

void System::violation(const State& state, VectorXd& phi) const {
  int row = 0;
  for (const joints::JointConstraint& joint : constraints_) {
    const int q = joint.coordinate();
    phi.segment(row, joint.rows()) =
        joint.violation(frame(state, joint.node_a()), frame(state, joint.node_b()), q < 0 ? 0.0 : state.s[q])
            .head(joint.rows());
    row += joint.rows();
  }
  for (const GearConstraint& gear : gears_)
    phi[row++] = state.s[gear.input] - gear.ratio * state.s[gear.output];
}

VectorXd System::law_tangents(const State& state, const TangentFactors& c, bool friction) const {
  VectorXd kappa(laws_.size());
  for (std::size_t k = 0; k < laws_.size(); ++k) {
    const PlacedLaw& law = laws_[k];
    kappa[k] = 0;
    if (!friction && !joints::acts_at_rest(law.law)) continue;
    const auto response = joints::respond(law.law, deflection(law, state.s),
                                          deflection(law, state.v.tail(n_scalars())), state.laws[k]);
    kappa[k] = c.stiffness * response.stiffness + c.damping * response.damping;
  }
  return kappa;
}

Eigen::SparseMatrix<double> System::tangent(const State& state, const Loads& loads, const TangentFactors& c,
                                            bool constraints) const {
  const int n = constraints ? n_unknowns() : n_free();
  std::vector<Eigen::Triplet<double>> entries;
  emit_tangent(state, loads, c, law_tangents(state, c, false), [&](int row, int column, double value) {
    if (row < n && column < n) entries.emplace_back(row, column, value);
  });
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Eigen::SparseMatrix<double> System::constraint_jacobian(const State& state) const {
  std::vector<Eigen::Triplet<double>> entries;
  emit_tangent(state, Loads{}, {0, 0, 0}, VectorXd::Zero(laws_.size()),
               [&](int row, int column, double value) {
                 if (row >= n_free()) entries.emplace_back(row - n_free(), column, value);
               });
  Eigen::SparseMatrix<double> J(n_constraints_, n_free());
  J.setFromTriplets(entries.begin(), entries.end());
  return J;
}

Frame System::point_frame(const State& state, int point) const {
  const Attachment& at = points_[point];
  if (at.element < 0) return state.frames[at.node] * at.offset;
  const elements::BeamElement& beam = beams_[at.element];
  return beam.interpolate(state.frames[beam.node1()], state.frames[beam.node2()], at.xi) * at.offset;
}

Vector6d System::point_velocity(const State& state, int point) const {
  const Attachment& at = points_[point];
  Vector6d v;
  if (at.element < 0) {
    v = state.v.segment<6>(6 * at.node);
  } else {
    const elements::BeamElement& beam = beams_[at.element];
    v = beam.interpolate_velocity(state.frames[beam.node1()], state.frames[beam.node2()],
                                  state.v.segment<6>(6 * beam.node1()), state.v.segment<6>(6 * beam.node2()),
                                  at.xi);
  }
  return adjoint(at.offset.inverse()) * v;
}

}  // namespace flexarm::assembly
