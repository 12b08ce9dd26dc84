#include <cmath>

#include "flexarm/assembly/planar_system.hpp"
#include "flexarm/assembly/plane_split.hpp"

namespace flexarm::assembly {
namespace {

using namespace geometry;
using Eigen::MatrixXd;
using joints::JointConstraint;
using joints::JointType;

// Of directions and of couplings in beams and bodies: rounding of rotations that are multiplied along an arm.
constexpr double rounding = 1e-12;
// Of the equilibrium from which a motion starts, as Newton's method leaves it.
constexpr double converged = 1e-9;

}  // namespace

/// Builds a PlanarSystem step by step; the first thing that does not fit is the obstacle.
class Projection {
 public:
  Projection(const System& system, const State& state, const Loads& loads, const Vector3d& normal)
      : system_(system), state_(state), loads_(loads), normal_(normal.normalized()) {
    std::vector<double> values;
    for (const JointCoordinates& joint : system.joints()) {
      values.push_back(joint.theta < 0 ? 0.0 : state.s[joint.theta]);
    }
    undeformed_ = system.open_state(values);
  }

  PlanarSystem::Attempt attempt() {
    flat_.reset(new PlanarSystem);
    const bool planar = nodes() && beams() && parts() && joints() && closures() && masses() && loads() &&
                        state_loads() && start();
    if (!planar) return {nullptr, obstacle_};
    points();
    flat_->pair_beams();
    return {std::move(flat_), ""};
  }

 private:
  bool refuse(const std::string& what) {
    obstacle_ = what;
    return false;
  }

  const std::string& link_of(int node) const {
    std::size_t k = system_.meshes().size() - 1;
    while (system_.meshes()[k].first_node > node) --k;
    return model::name_of(system_.arm().links[k]);
  }

  bool nodes() {
    Vector3d towards = Vector3d::UnitX();
    if (std::abs(normal_.x()) > 0.9) towards = Vector3d::UnitY();
    flat_->base_ = PlaneAxes::with_normal(normal_, towards);
    flat_->n_nodes_ = system_.n_nodes();
    flat_->reach_ = system_.reach();
    flat_->mass_ = system_.mass();
    flat_->meshes_ = system_.meshes();
    for (const Frame& H : undeformed_.frames) {
      PlaneAxes axes = flat_->base_.seen_from(H.R);
      const bool x_within = std::abs(axes.normal().x()) < rounding;  // as that of a beam's section
      flat_->axes_.push_back(x_within ? PlaneAxes::with_normal(axes.normal(), Vector3d::UnitX()) : axes);
      flat_->distance_.push_back(normal_.dot(H.x));
    }
    return true;
  }

  bool beams() {
    for (const elements::BeamElement& beam : system_.beams()) {
      const PlaneAxes& axes = flat_->axes_[beam.node1()];
      const std::string link = "link '" + link_of(beam.node1()) + "'";
      if (std::abs(axes.normal().x()) > rounding) return refuse(link + " points out of the plane");
      const MatrixXd K = beam.stiffness().asDiagonal();
      if (Split(axes, 1, system_.reach()).coupling(K) > rounding) {
        return refuse("the section of " + link + " bends across the plane when it bends within");
      }
      if (Split(axes, 2, system_.reach()).coupling(beam.mass()) > rounding) {
        return refuse("the mass of " + link + " couples the plane with what lies across");
      }
      if ((axes.across().transpose() * beam.bow()).norm() > rounding) {
        return refuse(link + " is bowed out of the plane");
      }
      flat_->beams_.emplace_back(beam, axes);
    }
    return true;
  }

  /// Scalar coordinates keep their order: free ones, modes, prescribed ones.
  bool parts() {
    const int n_space = system_.n_scalars();
    flat_->scalars_ = MatrixXd::Zero(n_space, n_space);
    new_index_.assign(n_space, -1);
    std::vector<bool> is_mode(n_space, false);
    for (const auto& part : system_.superelements()) {
      for (int k = 0; k < part.n_modes(); ++k) is_mode[part.mode(k)] = true;
    }
    const auto keep_coordinates = [&](bool free) {
      for (int k = 0; k < n_space; ++k) {
        if (is_mode[k] || system_.is_free(k) != free) continue;
        new_index_[k] = flat_->n_scalars();
        flat_->scalars_(k, new_index_[k]) = 1;
        flat_->scalar_inertia_.push_back(system_.scalar_inertia()[k]);
      }
    };
    keep_coordinates(true);
    for (const auto& part : system_.superelements()) {
      if (!add_part(part)) return false;
    }
    flat_->n_free_scalars_ = flat_->n_scalars();
    keep_coordinates(false);
    flat_->scalars_.conservativeResize(Eigen::NoChange, flat_->n_scalars());
    return true;
  }

  bool add_part(const elements::SuperElement& part) {
    const PlaneAxes& axes = flat_->axes_[part.node(0)];
    const ModeSplit modes = split_modes(part, axes);
    const int nodes = part.n_interfaces();
    const double length = system_.reach();
    const Split twists(axes, nodes, length, modes.kept, modes.left_out);
    const Split strains(axes, nodes - 1, length, modes.kept, modes.left_out);
    const MatrixXd pull = strains.across.transpose() * part.weight_by_deformation() * axes.E.leftCols<2>();
    const bool decoupled = twists.coupling(part.mass()) < reduced &&
                           strains.coupling(part.deformation_stiffness()) < reduced &&
                           strains.coupling(part.deformation_damping()) < reduced &&
                           (pull.size() == 0 || pull.cwiseAbs().maxCoeff() < reduced * system_.mass());
    if (!decoupled) return refuse("link '" + part.name() + "' is not symmetric to the plane");
    flat_->superelements_.emplace_back(part, axes, modes.kept, flat_->n_scalars());
    if (part.n_modes() > 0) {
      flat_->scalars_.block(part.mode(0), flat_->n_scalars(), part.n_modes(), modes.kept.cols()) = modes.kept;
    }
    flat_->scalar_inertia_.resize(flat_->scalar_inertia_.size() + modes.kept.cols(), 0.0);
    return true;
  }

  bool joints() {
    const double length = system_.reach();
    for (std::size_t k = 0; k < system_.constraints().size(); ++k) {
      const JointConstraint& joint = system_.constraints()[k];
      const std::string name = name_of(k);
      const bool on_ground = joint.node_a() == JointConstraint::ground;
      const bool grounded = on_ground || joint.node_a() == system_.pedestal().node;
      const PlaneAxes& at_a = on_ground ? flat_->base_ : flat_->axes_[joint.node_a()];
      const PlaneAxes& at_b = flat_->axes_[joint.node_b()];
      const Frame X_a = joint.frame_a(), &X_b = joint.frame_b();
      const PlaneAxes b_axes = at_b.seen_from(X_b.R);
      const bool ball = joint.type() == JointType::spherical;
      const PlaneAxes a_axes = ball ? at_a.seen_from(X_a.R) : b_axes;
      if (tilt(X_a, at_a, a_axes) > rounding ||
          (b_axes.across().transpose() * joint.twist()).norm() > rounding) {
        return refuse(name + " moves out of the plane");
      }
      const double off_a = at_a.normal().dot(X_a.x), off_b = at_b.normal().dot(X_b.x);
      if (std::max(grounded ? 0.0 : std::abs(off_a), std::abs(off_b)) > rounding * length) {
        return refuse(name + " stands out of the plane of the links that it joins");
      }
      const int q = joint.coordinate();
      flat_->constraints_.emplace_back(joint.type(), joint.node_a(), in_plane(X_a, at_a, a_axes),
                                       joint.node_b(), in_plane(X_b, at_b, b_axes),
                                       b_axes.within().transpose() * joint.twist(),
                                       q < 0 ? q : new_index_[q]);
      flat_->n_constraints_ += flat_->constraints_.back().rows();
      flat_->joint_axes_.push_back(b_axes);
      flat_->ground_distance_.push_back(grounded ? off_a : 0.0);
    }
    couple_scalars();
    return true;
  }

  bool closures() {
    const LoopClosures& loops = system_.closures();
    MatrixXd combinations = MatrixXd::Zero(loops.conditions(), 0);
    for (std::size_t k = 0; k < loops.size(); ++k) {
      const joints::ClosureConstraint& closure = loops[k];
      const std::string name = "closure '" + loops.name(k) + "'";
      const auto side = [&](int node) -> const PlaneAxes& {
        return node < 0 ? flat_->base_ : flat_->axes_[node];
      };
      const PlaneAxes &at_a = side(closure.node_a()), &at_b = side(closure.node_b());
      auto part = closure.planar_part(at_a, at_b);
      if (!part) return refuse(name + " ties what lies across the plane to what lies within");
      const auto distance = [&](int node, const Vector3d& x) {
        return node < 0 || node == system_.pedestal().node ? 0.0 : std::abs(side(node).normal().dot(x));
      };
      if (std::max(distance(closure.node_a(), closure.frame_a().x),
                   distance(closure.node_b(), closure.frame_b().x)) > rounding * system_.reach()) {
        return refuse(name + " stands out of the plane of the links that it joins");
      }
      std::optional<BeamSlideIn<2>> slide;
      if (const auto& in_space = loops.slide(k)) {
        slide = BeamSlideIn<2>(*in_space, at_a, at_b);
        part->combinations = at_a.E.block<2, 1>(1, 1);  // y and z of the beam's sections
      }
      flat_->closures_.add(loops.name(k), part->closure, slide);
      const MatrixXd before = combinations;
      combinations = MatrixXd::Zero(loops.conditions(), flat_->closures_.conditions());
      combinations.leftCols(before.cols()) = before;
      combinations.block(loops.first_condition(k), before.cols(), part->combinations.rows(),
                         part->combinations.cols()) = part->combinations;
      const int b = closure.node_b();
      flat_->ground_distance_.push_back((b < 0 ? 0.0 : flat_->distance_[b]) +
                                        side(b).normal().dot(closure.frame_b().x));
    }
    flat_->closings_ = loops.counted().transpose() * combinations;
    const MatrixXd counted = flat_->closings_.transpose() * flat_->closings_;
    if (!counted.isIdentity(reduced)) return refuse("its loops repeat conditions within the plane");
    flat_->n_constraints_ += flat_->closures_.rows();
    return true;
  }

  /// Of a constraint: behind those of the joints come the hinges of the base, then those of mounts.
  std::string name_of(std::size_t constraint) const {
    const auto& joints = system_.arm().joints;
    if (constraint < joints.size()) return "joint '" + joints[constraint].name + "'";
    const std::size_t hinge = constraint - joints.size();
    return hinge < system_.pedestal().thetas.size() ? "the base" : "the mount of a joint";
  }

  void couple_scalars() {
    const auto now = [&](int k) { return k < 0 ? k : new_index_[k]; };
    flat_->gears_ = system_.gears();
    for (joints::GearConstraint& gear : flat_->gears_) {
      gear.input = now(gear.input);
      gear.output = now(gear.output);
      ++flat_->n_constraints_;
    }
    for (const PlacedLaw& law : system_.laws()) {
      flat_->laws_.push_back({law.law, now(law.plus), now(law.minus), now(law.of)});
    }
    for (const JointCoordinates& at : system_.joints()) {
      flat_->joint_coordinates_.push_back({now(at.theta), now(at.phi), now(at.psi)});
    }
    flat_->pedestal_ = system_.pedestal();
    for (int& theta : flat_->pedestal_.thetas) theta = now(theta);
    for (const HingeCoordinates& at : system_.hinges()) flat_->hinges_.push_back({at.node, now(at.theta)});
    flat_->drives_ = system_.drives();
  }

  bool masses() {
    const double length = system_.reach();
    for (const elements::RigidBody& body : system_.bodies()) {
      const PlaneAxes& axes = flat_->axes_[body.node()];
      if (Split(axes, 1, length).coupling(body.mass()) > rounding) {
        return refuse("a mass on link '" + link_of(body.node()) + "' is not symmetric to the plane");
      }
      const auto P = axes.within();
      flat_->bodies_.emplace_back(body.node(), P.transpose() * body.mass() * P);
    }
    for (int k = 0; k < system_.n_nodes(); ++k) {
      const elements::Weight& weight = system_.weights()[k];
      if (std::abs(flat_->axes_[k].normal().dot(weight.moment)) > reduced * system_.mass() * length) {
        return refuse("the weight of link '" + link_of(k) + "' pulls out of the plane");
      }
      flat_->weights_.push_back({weight.mass, flat_->axes_[k].part(weight.moment)});
    }
    return true;
  }

  bool loads() {
    if (std::abs(normal_.dot(loads_.gravity)) > rounding * loads_.gravity.norm()) {
      return refuse("gravity points out of the plane");
    }
    for (const PointLoad& load : loads_.points) {
      const Attachment& at = system_.points()[load.point];
      const PlaneAxes& axes = flat_->axes_[at.node];
      const Vector3d n = load.follows ? axes.seen_from(at.offset.R).normal() : normal_;
      const double lever = axes.normal().dot(at.offset.x);
      const double across = std::abs(n.dot(load.force)) + (load.moment - n * n.dot(load.moment)).norm() +
                            std::abs(lever) * load.force.norm();
      if (across > rounding * (load.force.norm() + load.moment.norm())) {
        return refuse("the load at point '" + system_.arm().points[load.point].name +
                      "' points out of the plane");
      }
    }
    return true;
  }

  bool state_loads() {
    const auto placed = [&](PlacedTable table) {
      table.scalar = new_index_[table.scalar];
      return table;
    };
    for (const RestStrainIn<3>& load : system_.rest_strains()) {
      const int node = system_.beams()[load.beam].node1();
      const PlaneAxes& axes = flat_->axes_[node];
      if ((axes.across().transpose() * load.strain).norm() > rounding * load.strain.norm())
        return refuse("the tabulated curvature of link '" + link_of(node) + "' bends it out of the plane");
      flat_->rest_strains_.push_back(
          {placed(load.table), load.beam, axes.within().transpose() * load.strain});
    }
    for (const StateForceIn<3>& load : system_.state_forces()) {
      const PlaneAxes& axes = flat_->axes_[load.node];
      const double across = std::abs(normal_.dot(load.force));
      if (across > rounding * load.force.norm() ||
          std::abs(axes.normal().dot(load.place)) > rounding * system_.reach())
        return refuse("the tabulated force on link '" + link_of(load.node) + "' pulls out of the plane");
      flat_->state_forces_.push_back(
          {placed(load.table), load.node, axes.part(load.place), flat_->base_.part(load.force)});
    }
    return true;
  }

  bool start() {
    for (int k = 0; k < system_.n_nodes(); ++k) {
      const Frame& H = state_.frames[k];
      const double away = std::abs(normal_.dot(H.x) - flat_->distance_[k]);
      if (tilt(H, flat_->base_, flat_->axes_[k]) > converged || away > converged * system_.reach()) {
        return refuse("the arm stands out of the plane where the motion starts");
      }
    }
    return true;
  }

  void points() {
    for (const Attachment& at : system_.points()) {
      const PlaneAxes& axes = flat_->axes_[at.node];
      flat_->points_.push_back({at.node, at.element, at.xi, FrameIn<2>::translation(axes.part(at.offset.x))});
      flat_->point_axes_.push_back(axes.seen_from(at.offset.R));
      flat_->point_distance_.push_back(flat_->distance_[at.node] + axes.normal().dot(at.offset.x));
    }
  }

  const System& system_;
  const State& state_;
  const Loads& loads_;
  Vector3d normal_;
  State undeformed_;
  std::vector<int> new_index_;  // of the scalar coordinates
  std::unique_ptr<PlanarSystem> flat_;
  std::string obstacle_;
};

namespace {

/// Normals that the arm's own axes allow: that of its hinges, or what its slides and sections leave.
std::vector<Vector3d> possible_normals(const System& system, const State& state, const Vector3d& gravity) {
  std::vector<Vector3d> normals;
  const auto along = [&](const JointConstraint& joint) -> Matrix3d {
    return state.frames[joint.node_b()].R * joint.frame_b().R;
  };
  for (const JointConstraint& joint : system.constraints()) {
    if (joint.type() == JointType::revolute) return {along(joint) * joint.twist().tail<3>()};
  }
  for (const JointConstraint& joint : system.constraints()) {
    normals.push_back(gravity.cross(along(joint) * joint.twist().head<3>()));
  }
  for (const elements::BeamElement& beam : system.beams()) {
    const Matrix3d& R = state.frames[beam.node1()].R;
    normals.insert(normals.end(), {R.col(1), R.col(2), gravity.cross(R.col(0))});
  }
  std::erase_if(normals, [](const Vector3d& n) { return n.norm() < 1e-6; });
  return normals;
}

}  // namespace

PlanarSystem::Attempt PlanarSystem::about(const System& system, const State& state, const Loads& loads) {
  Attempt attempt{nullptr, "no direction of the arm could be the normal of a plane"};
  for (const Vector3d& normal : possible_normals(system, state, loads.gravity)) {
    attempt = Projection(system, state, loads, normal).attempt();
    if (attempt.system) break;
  }
  return attempt;
}

}  // namespace flexarm::assembly
