/// @file
/// An arm, assembled: nodes, elements, constraints and laws with their place among the unknowns.
///
///     M(v') − ad(v)ᵀ M v + f_int(H, v) + Φ_qᵀ λ = f_ext + τ                                          (1)
///     Φ(H, s, t) = 0                                                                                 (2)
///
/// Unknowns are, in this order, six components a node, the free scalar coordinates, the multipliers.
/// Scalar coordinates are angles of joints and amplitudes of internal modes. Prescribed ones (driven angles)
/// come after the free ones; their rows of (1) yield the torque that drives them. A System is constant after
/// assembly; everything that moves is in the State.
#pragma once

#include <Eigen/SparseCore>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "flexarm/assembly/mesh.hpp"
#include "flexarm/assembly/state.hpp"
#include "flexarm/elements/beam.hpp"
#include "flexarm/elements/rigid_body.hpp"
#include "flexarm/elements/superelement.hpp"
#include "flexarm/elements/weight.hpp"
#include "flexarm/joints/joint_constraint.hpp"
#include "flexarm/model/arm.hpp"

namespace flexarm::assembly {

/// What a joint's motor is told.
enum class DriveKind {
  motor_angle,  ///< φ is prescribed
  link_angle,   ///< θ is prescribed; springs of the drive train do not matter
  torque,       ///< the motor's torque is prescribed (output-referred)
  free,         ///< no torque
  locked,       ///< φ stays
};

/// A joint's place among the scalar coordinates; −1 where it has none. Without a transmission psi == phi,
/// without stages theta == psi.
struct JointCoordinates {
  int theta = -1, phi = -1, psi = -1;
};

/// A law between two scalar coordinates: x = s[plus] − s[minus], or s[plus] alone (minus = −1).
struct PlacedLaw {
  joints::JointLaw law;
  int plus, minus;
};

/// The base's own node and angle, where it turns on a pedestal; −1 where it stands still.
struct PedestalCoordinates {
  int node = joints::JointConstraint::ground, theta = -1;
};

/// A force and a moment at a point: in the base's axes (dead) or in the link's (following).
struct PointLoad {
  int point = 0;
  Vector3d force = Vector3d::Zero();
  Vector3d moment = Vector3d::Zero();
  bool follows = false;
};

/// What acts on the arm from outside.
struct Loads {
  Vector3d gravity{0, 0, -9.81};
  std::vector<PointLoad> points;
  VectorXd torques;  ///< on the scalar coordinates, by the motors; empty: none
};

/// Factors of mass, damping and stiffness in a tangent matrix c_M M + c_C C + c_K K.
struct TangentFactors {
  double mass, damping, stiffness;
  double constraint = 1;  ///< scale s of constraints and multipliers: rows s Φ, forces s Φ_qᵀ λ̂
};

class System {
 public:
  /// @throws InvalidParameter naming what does not fit.
  System(const model::Arm& arm, const std::map<std::string, DriveKind>& drives);

  const model::Arm& arm() const { return arm_; }
  int n_nodes() const { return n_nodes_; }
  int n_scalars() const { return static_cast<int>(scalar_inertia_.size()); }
  int n_velocities() const { return 6 * n_nodes_ + n_scalars(); }
  int n_free() const { return 6 * n_nodes_ + n_free_scalars_; }
  int n_constraints() const { return n_constraints_; }
  int n_unknowns() const { return n_free() + n_constraints_; }
  int scalar_offset() const { return 6 * n_nodes_; }
  bool is_free(int scalar) const { return scalar < n_free_scalars_; }

  const std::vector<LinkMesh>& meshes() const { return meshes_; }
  const std::vector<elements::BeamElement>& beams() const { return beams_; }
  const std::vector<elements::RigidBody>& bodies() const { return bodies_; }
  const std::vector<elements::SuperElement>& superelements() const { return superelements_; }
  const std::vector<elements::Weight>& weights() const { return weights_; }      ///< one a node
  const std::vector<double>& scalar_inertia() const { return scalar_inertia_; }  ///< one a scalar coordinate
  const std::vector<joints::JointConstraint>& constraints() const { return constraints_; }
  /// Gears between joints first, each with θ of its input and φ of its output; then the transmissions of
  /// joints, from φ to ψ.
  const std::vector<joints::GearConstraint>& gears() const { return gears_; }
  /// The transmission of a joint; null without one.
  const joints::Transmission* transmission(int joint) const;
  const std::vector<PlacedLaw>& laws() const { return laws_; }
  const std::vector<JointCoordinates>& joints() const { return joint_coordinates_; }
  const std::vector<DriveKind>& drives() const { return drives_; }
  const PedestalCoordinates& pedestal() const { return pedestal_; }
  const std::vector<Attachment>& points() const { return points_; }
  int joint_index(const std::string& name) const;  ///< @throws InvalidParameter listing the joints there are
  int point_index(const std::string& name) const;
  double reach() const { return reach_; }  ///< a length of the arm, to scale by [m]
  double mass() const { return mass_; }    ///< of everything [kg]

  /// The undeformed arm at these joint values (one a joint), at rest.
  State rigid_state(const std::vector<double>& joint_values) const;

  /// Left side minus right side of (1) for all velocities, prescribed ones included; `r` has n_velocities()
  /// entries. `friction` leaves out what has no part in statics: laws that only resist motion.
  void residual(const State& state, const Loads& loads, bool friction, VectorXd& r) const;

  /// The rows of the scalar coordinates without motor torques: what a motor must give. n_scalars() entries.
  void scalar_residual(const State& state, bool friction, Eigen::Ref<VectorXd> r) const;

  /// Equation (2).
  void violation(const State& state, VectorXd& phi) const;

  /// Tangent of (1), (2) with respect to the unknowns, as triplets in an order that never changes:
  /// add(row, column, value). `law_tangents` are the stiffnesses to use for the laws.
  template <class Add>
  void emit_tangent(const State& state, const Loads& loads, const TangentFactors& c,
                    const VectorXd& law_tangents, Add&& add) const;

  /// The same as a sparse matrix; with `constraints` off only the n_free() x n_free() block.
  Eigen::SparseMatrix<double> tangent(const State& state, const Loads& loads, const TangentFactors& c,
                                      bool constraints = true) const;

  /// ∂Φ/∂(free velocities).
  Eigen::SparseMatrix<double> constraint_jacobian(const State& state) const;

  /// c_K ∂Q/∂x + c_C ∂Q/∂x' of every law at the state.
  VectorXd law_tangents(const State& state, const TangentFactors& c, bool friction) const;

  double deflection(const PlacedLaw& law, const Eigen::Ref<const VectorXd>& s) const {
    return s[law.plus] - (law.minus < 0 ? 0.0 : s[law.minus]);
  }

  /// The part of a state that a super-element sees, and its velocities (or accelerations) out of all of them.
  elements::SuperElement::Configuration configuration(const elements::SuperElement& part,
                                                      const State& state) const;
  VectorXd velocities(const elements::SuperElement& part, const VectorXd& v) const;

  /// Makes the state the one from which laws with memory count.
  void remember(State& state) const;

  /// Frame of a point (link axes there), and its velocity in those axes.
  Frame point_frame(const State& state, int point) const;
  geometry::Vector6d point_velocity(const State& state, int point) const;

 private:
  void mesh_links(const std::vector<std::vector<double>>& occupied);
  void place_scalars(const std::map<std::string, DriveKind>& drives);
  void place_superelements();
  void place_joints();
  void place_gears();
  void place_transmissions();
  void place_masses();
  void set_damping();
  void set_bows();
  int link_index(const std::string& name) const;
  /// @throws InvalidParameter if there is no such link or interface, or the interface is not named.
  Place place(const std::string& name, bool at_end = false) const;
  int node(const Place& place) const { return meshes_[place.link].first_node + place.node; }
  Frame axes(const Place& place) const { return meshes_[place.link].place_axes(place.node); }
  int row(const elements::SuperElement& part, int k) const;  // of its k-th velocity
  /// @throws InvalidParameter if there is no such point, or it has no node of its own to be loaded at.
  const Attachment& loaded_point(int point) const;
  const Frame& frame(const State& state, int node) const;

  model::Arm arm_;
  int n_nodes_ = 0, n_free_scalars_ = 0, n_constraints_ = 0;
  double reach_ = 0, mass_ = 0;
  std::vector<LinkMesh> meshes_;
  std::vector<elements::BeamElement> beams_;
  std::vector<elements::RigidBody> bodies_;
  std::vector<elements::SuperElement> superelements_;
  std::vector<elements::Weight> weights_;  // one a node
  std::vector<joints::JointConstraint> constraints_;
  std::vector<joints::GearConstraint> gears_;
  std::vector<PlacedLaw> laws_;
  std::vector<JointCoordinates> joint_coordinates_;
  PedestalCoordinates pedestal_;
  std::vector<DriveKind> drives_;
  std::vector<double> scalar_inertia_;
  std::vector<Attachment> points_;
};

template <class Add>
void System::emit_tangent(const State& state, const Loads& loads, const TangentFactors& c,
                          const VectorXd& law_tangents, Add&& add) const {
  const auto block = [&](int row, int column, const auto& B) {
    for (int j = 0; j < B.cols(); ++j)
      for (int i = 0; i < B.rows(); ++i) add(row + i, column + j, B(i, j));
  };
  const auto scalar = [&](int row, int column, double value) {
    if (is_free(row) && is_free(column)) add(scalar_offset() + row, scalar_offset() + column, value);
  };

  for (const elements::BeamElement& beam : beams_) {
    const int n1 = 6 * beam.node1(), n2 = 6 * beam.node2();
    const Frame &H1 = state.frames[beam.node1()], &H2 = state.frames[beam.node2()];
    elements::Vector12d v;
    v << state.v.segment<6>(n1), state.v.segment<6>(n2);
    elements::Matrix12d S = c.mass * beam.mass();
    if (c.stiffness != 0) {
      S += c.stiffness * beam.stiffness_matrix(H1, H2, v.head<6>(), v.tail<6>(), state.elapsed());
    }
    if (c.damping != 0) S += c.damping * (beam.damping_matrix(H1, H2) + beam.gyroscopic_matrix(v));
    block(n1, n1, S.topLeftCorner<6, 6>());
    block(n1, n2, S.topRightCorner<6, 6>());
    block(n2, n1, S.bottomLeftCorner<6, 6>());
    block(n2, n2, S.bottomRightCorner<6, 6>());
  }
  for (const elements::RigidBody& body : bodies_) {
    const int n = 6 * body.node();
    block(
        n, n,
        geometry::Matrix6d(c.mass * body.mass() + c.damping * body.gyroscopic_matrix(state.v.segment<6>(n))));
  }
  for (const elements::SuperElement& part : superelements_) {
    const auto at = configuration(part, state);
    Eigen::MatrixXd S = c.mass * part.mass();
    const VectorXd V = velocities(part, state.v);
    if (c.stiffness != 0) S += c.stiffness * part.stiffness_matrix(at, V, loads.gravity);
    if (c.damping != 0) S += c.damping * (part.damping_matrix(at) + part.gyroscopic_matrix(V));
    for (int j = 0; j < part.size(); ++j)
      for (int i = 0; i < part.size(); ++i) add(row(part, i), row(part, j), S(i, j));
  }
  for (int n = 0; n < n_nodes_; ++n) {
    block(6 * n, 6 * n,
          geometry::Matrix6d(c.stiffness * weights_[n].stiffness(state.frames[n].R, loads.gravity)));
  }
  for (const PointLoad& load : loads.points) {
    const Attachment& at = loaded_point(load.point);
    if (load.follows) continue;
    const Matrix3d& R = state.frames[at.node].R;
    geometry::Matrix6d K = elements::Weight{1, at.offset.x}.stiffness(R, load.force);
    K.bottomRightCorner<3, 3>() -= geometry::skew(R.transpose() * load.moment);
    block(6 * at.node, 6 * at.node, geometry::Matrix6d(c.stiffness * K));
  }
  for (int s = 0; s < n_free_scalars_; ++s) scalar(s, s, c.mass * scalar_inertia_[s]);
  for (std::size_t k = 0; k < laws_.size(); ++k) {
    const double kappa = law_tangents[k];
    const PlacedLaw& law = laws_[k];
    scalar(law.plus, law.plus, kappa);
    if (law.minus < 0) continue;
    scalar(law.minus, law.minus, kappa);
    scalar(law.plus, law.minus, -kappa);
    scalar(law.minus, law.plus, -kappa);
  }

  int first_row = n_free();
  for (const joints::JointConstraint& joint : constraints_) {
    const int a = joint.node_a(), b = joint.node_b(), q = joint.coordinate(), m = joint.rows();
    const Frame &H_a = frame(state, a), &H_b = frame(state, b);
    const double theta = q < 0 ? 0.0 : state.s[q];
    const auto J = joint.jacobian(H_a, H_b, theta);
    geometry::Vector6d lambda = geometry::Vector6d::Zero();
    lambda.head(m) = state.multipliers.segment(first_row - n_free(), m);
    const auto K = joint.geometric_stiffness(H_a, H_b, theta, lambda);
    const auto both = [&](int column, const auto& B) {  // constraint rows and, transposed, multiplier columns
      block(first_row, column, (c.constraint * B.topRows(m)).eval());
      block(column, first_row, (c.constraint * B.topRows(m).transpose()).eval());
    };
    both(6 * b, J.b);
    if (a >= 0) {
      both(6 * a, J.a);
      if (joint.rows() == 3) {
        block(6 * a, 6 * a, geometry::Matrix6d(c.stiffness * K.a_a));
        block(6 * a, 6 * b, geometry::Matrix6d(c.stiffness * K.a_b));
      }
    }
    if (q >= 0 && is_free(q)) {
      both(scalar_offset() + q, J.theta);
      if (a >= 0) block(6 * a, scalar_offset() + q, geometry::Vector6d(c.stiffness * K.a_theta));
    }
    first_row += m;
  }
  for (const joints::GearConstraint& gear : gears_) {
    const auto both = [&](int coordinate, double value) {
      if (!is_free(coordinate)) return;
      add(first_row, scalar_offset() + coordinate, c.constraint * value);
      add(scalar_offset() + coordinate, first_row, c.constraint * value);
    };
    const auto psi = gear.transmission(state.s[gear.input]);
    both(gear.input, psi.first);
    both(gear.output, -1);
    scalar(gear.input, gear.input, c.stiffness * psi.second * state.multipliers[first_row - n_free()]);
    ++first_row;
  }
}

}  // namespace flexarm::assembly
