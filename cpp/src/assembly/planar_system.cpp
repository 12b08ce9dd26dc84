#include "flexarm/assembly/planar_system.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

namespace flexarm::assembly {
namespace {

using namespace geometry;
using Eigen::MatrixXd;
using joints::JointConstraint;
using joints::JointType;

// Of directions and of couplings in beams and bodies: rounding of rotations that are multiplied along an arm.
constexpr double rounding = 1e-12;
// Of couplings in reduced parts, whose modes come from an iteration that stops near this.
constexpr double reduced = 1e-9;
// Of the equilibrium from which a motion starts, as Newton's method leaves it.
constexpr double converged = 1e-9;

/// Twists within and across the plane of `nodes` nodes with the same axes, then combinations of modes.
/// Rotations are per length, so that all columns have one unit.
struct Split {
  MatrixXd within, across;

  Split(const PlaneAxes& axes, int nodes, double length, const MatrixXd& kept, const MatrixXd& left_out) {
    const Eigen::Index m = kept.rows();
    within = MatrixXd::Zero(6 * nodes + m, 3 * nodes + kept.cols());
    across = MatrixXd::Zero(6 * nodes + m, 3 * nodes + left_out.cols());
    const Vector3d scale_within(1, 1, 1 / length), scale_across(1, 1 / length, 1 / length);
    for (int i = 0; i < nodes; ++i) {
      within.block<6, 3>(6 * i, 3 * i) = axes.within() * scale_within.asDiagonal();
      across.block<6, 3>(6 * i, 3 * i) = axes.across() * scale_across.asDiagonal();
    }
    within.bottomRightCorner(m, kept.cols()) = kept;
    across.bottomRightCorner(m, left_out.cols()) = left_out;
  }
  Split(const PlaneAxes& axes, int nodes, double length)
      : Split(axes, nodes, length, MatrixXd(0, 0), MatrixXd(0, 0)) {}

  /// Largest |q A p| beside √(A_q A_p); against translations, whatever resists less.
  double coupling(const MatrixXd& A) const {
    const Eigen::ArrayXd p = (within.transpose() * A * within).diagonal();
    const Eigen::ArrayXd q = (across.transpose() * A * across).diagonal();
    const double translation = p.size() > 1 ? std::max({p[0], p[1], q[0]}) : 0.0;
    const Eigen::VectorXd beside_p = p.max(translation).sqrt(), beside_q = q.max(translation).sqrt();
    const Eigen::MatrixXd between = across.transpose() * A * within;
    return translation > 0 ? (between.array() / (beside_q * beside_p.transpose()).array()).abs().maxCoeff()
                           : 0.0;
  }
};

/// Combinations of a part's modes: those that the plane moves, and the rest.
struct ModeSplit {
  MatrixXd kept, left_out;
};

/// Modes of one frequency may come as any combination of each other, so each group of equal frequencies is
/// turned until its first members take all that couples it to the plane.
ModeSplit split_modes(const elements::SuperElement& part, const PlaneAxes& axes) {
  const int m = part.n_modes(), nodes = part.n_interfaces();
  if (m == 0) return {MatrixXd(0, 0), MatrixXd(0, 0)};
  const MatrixXd K = part.deformation_stiffness().bottomRightCorner(m, m);
  const MatrixXd M = part.mass().bottomRightCorner(m, m);
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(K, M);
  const MatrixXd shapes = std::sqrt(M(0, 0)) * modes.eigenvectors();  // unit columns where M is mass times I
  const Split split(axes, nodes, 1.0);
  const MatrixXd coupling = split.within.transpose() * part.mass().topRightCorner(6 * nodes, m) * shapes;
  const double beside = part.mass().diagonal().maxCoeff();

  ModeSplit found{MatrixXd(m, 0), MatrixXd(m, 0)};
  const auto append = [](MatrixXd& to, const MatrixXd& columns) {
    const Eigen::Index before = to.cols();
    to.conservativeResize(Eigen::NoChange, before + columns.cols());
    to.rightCols(columns.cols()) = columns;
  };
  const auto& omega_squared = modes.eigenvalues();
  for (int first = 0, next; first < m; first = next) {
    for (next = first + 1; next < m && omega_squared[next] < (1 + 1e-6) * omega_squared[next - 1];) ++next;
    const int size = next - first;
    const Eigen::JacobiSVD<MatrixXd> turned(coupling.middleCols(first, size), Eigen::ComputeFullV);
    const Eigen::Index moved = (turned.singularValues().array() > reduced * beside).count();
    const MatrixXd group = shapes.middleCols(first, size) * turned.matrixV();
    append(found.kept, group.leftCols(moved));
    append(found.left_out, group.rightCols(size - moved));
  }
  return found;
}

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
    undeformed_ = system.rigid_state(values);
  }

  PlanarSystem::Attempt attempt() {
    flat_.reset(new PlanarSystem);
    const bool planar = nodes() && beams() && parts() && joints() && masses() && loads() && start();
    if (!planar) return {nullptr, obstacle_};
    points();
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
      const bool of_base = k >= system_.arm().joints.size();
      const std::string name = of_base ? "the base" : "joint '" + system_.arm().joints[k].name + "'";
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
        return refuse(name + " stands beside the plane of the links that it joins");
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

  void couple_scalars() {
    const auto now = [&](int k) { return k < 0 ? k : new_index_[k]; };
    flat_->gears_ = system_.gears();
    for (joints::GearConstraint& gear : flat_->gears_) {
      gear.input = now(gear.input);
      gear.output = now(gear.output);
      ++flat_->n_constraints_;
    }
    for (const PlacedLaw& law : system_.laws()) {
      flat_->laws_.push_back({law.law, now(law.plus), now(law.minus)});
    }
    for (const JointCoordinates& at : system_.joints()) {
      flat_->joint_coordinates_.push_back({now(at.theta), now(at.phi), now(at.psi)});
    }
    flat_->pedestal_ = system_.pedestal();
    flat_->pedestal_.theta = now(system_.pedestal().theta);
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
        return refuse("the weight of link '" + link_of(k) + "' pulls beside the plane");
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

bool PlanarSystem::same_coordinates(const PlanarSystem& other) const {
  const auto near = [](const PlaneAxes& a, const PlaneAxes& b) { return a.E.isApprox(b.E, 1e-12); };
  bool same = near(base_, other.base_) && axes_.size() == other.axes_.size() &&
              scalars_.rows() == other.scalars_.rows() && scalars_.cols() == other.scalars_.cols() &&
              scalars_.isApprox(other.scalars_, 1e-12);
  for (std::size_t k = 0; same && k < axes_.size(); ++k) same = near(axes_[k], other.axes_[k]);
  return same;
}

StateIn<2> PlanarSystem::part(const State& state) const {
  StateIn<2> flat;
  flat.t = state.t;
  flat.laws = state.laws;
  const Eigen::Index n_space = state.s.size();
  const Eigen::HouseholderQR<MatrixXd> combinations(scalars_);
  const auto coordinates = [&](const auto& s) -> VectorXd {
    if (n_scalars() == 0) return VectorXd(0);
    return combinations.solve(s);
  };
  const auto velocities = [&](const VectorXd& v) {
    VectorXd out(n_velocities());
    for (int k = 0; k < n_nodes_; ++k) {
      out.segment<3>(3 * k) = axes_[k].within().transpose() * v.segment<6>(6 * k);
    }
    out.tail(n_scalars()) = coordinates(VectorXd(v.tail(n_space)));
    return out;
  };
  for (int k = 0; k < n_nodes_; ++k) flat.frames.push_back(in_plane(state.frames[k], base_, axes_[k]));
  flat.s = coordinates(state.s);
  flat.v = velocities(state.v);
  flat.v_dot = velocities(state.v_dot);
  flat.a = velocities(state.a);
  flat.multipliers.resize(n_constraints_);
  int row = 0, row_space = 0;
  for (std::size_t k = 0; k < constraints_.size(); ++k) {
    const int rows = constraints_[k].rows(), rows_space = rows == 3 ? 6 : 3;
    flat.multipliers.segment(row, rows) =
        joint_axes_[k].within().topLeftCorner(rows_space, rows).transpose() *
        state.multipliers.segment(row_space, rows_space);
    row += rows;
    row_space += rows_space;
  }
  flat.multipliers.tail(n_constraints_ - row) = state.multipliers.tail(n_constraints_ - row);
  return flat;
}

LoadsIn<2> PlanarSystem::part(const Loads& loads) const {
  LoadsIn<2> flat;
  flat.gravity = base_.part(loads.gravity);
  for (const PointLoad& load : loads.points) {
    const PlaneAxes& axes = load.follows ? point_axes_[load.point] : base_;
    flat.points.push_back(
        {load.point, axes.part(load.force), Turn<2>(axes.normal().dot(load.moment)), load.follows});
  }
  if (loads.torques.size() > 0) flat.torques = scalars_.transpose() * loads.torques;
  return flat;
}

State PlanarSystem::embed(const StateIn<2>& state, const State& start) const {
  State full = start;
  full.t = state.t;
  full.laws = state.laws;
  const auto velocities = [&](const VectorXd& v, VectorXd& out) {
    for (int k = 0; k < n_nodes_; ++k) out.segment<6>(6 * k) = axes_[k].within() * v.segment<3>(3 * k);
    out.tail(scalars_.rows()) = scalars_ * v.tail(n_scalars());
  };
  for (int k = 0; k < n_nodes_; ++k) {
    full.frames[k] = in_space(state.frames[k], distance_[k], base_, axes_[k]);
  }
  full.s = scalars_ * state.s;
  velocities(state.v, full.v);
  velocities(state.v_dot, full.v_dot);
  velocities(state.a, full.a);
  int row = 0, row_space = 0;
  for (std::size_t k = 0; k < constraints_.size(); ++k) {
    const int rows = constraints_[k].rows(), rows_space = rows == 3 ? 6 : 3;
    full.multipliers.segment(row_space, rows_space) =
        joint_axes_[k].within().topLeftCorner(rows_space, rows) * state.multipliers.segment(row, rows);
    row += rows;
    row_space += rows_space;
  }
  full.multipliers.tail(n_constraints_ - row) = state.multipliers.tail(n_constraints_ - row);
  return full;
}

}  // namespace flexarm::assembly
