/// @file
/// The assembled equations of motion: nodes, elements, constraints and laws with their place among the
/// unknowns, in space (D = 3) or in a plane (D = 2).
///
///     M(v') − ad(v)ᵀ M v + f_int(H, v) + Φ_qᵀ λ = f_ext + τ                                          (1)
///     Φ(H, s, t) = 0                                                                                 (2)
///
/// Unknowns are, in this order, the freedoms of every node (six, three in a plane), the free scalar
/// coordinates, the multipliers: of joints, gears, transmissions, closures of loops. Scalar coordinates are
/// angles of joints and amplitudes of internal modes. Prescribed ones (driven angles) come after the free
/// ones; their rows of (1) yield the torque that drives them. Equations are constant after assembly;
/// everything that moves is in the State.
#pragma once

#include <Eigen/SparseCore>
#include <span>
#include <string>
#include <vector>

#include "flexarm/assembly/loop_closures.hpp"
#include "flexarm/assembly/mesh.hpp"
#include "flexarm/assembly/state.hpp"
#include "flexarm/assembly/state_loads.hpp"
#include "flexarm/elements/beam_pair.hpp"
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

/// A law between two scalar coordinates: x = s[plus] − s[minus], or s[plus] alone (minus = −1). Where `of` is
/// not −1, s[of] is the law's second argument y.
struct PlacedLaw {
  joints::JointLaw law;
  int plus, minus;
  int of = -1;

  /// Whether it turns a hinge by a table of a joint's state.
  bool moves_hinge() const { return minus < 0 && std::holds_alternative<joints::WoundSpring>(law); }
};

/// The node that turns on a hinge of the base or of a joint's mount, and its angle.
struct HingeCoordinates {
  int node, theta = -1;
};

/// The base's own node, where it turns on a pedestal (−1 where it stands still), and what shakes that.
struct PedestalCoordinates {
  int node = joints::JointConstraint::ground;
  std::vector<int> thetas = {};      ///< of its hinges
  std::vector<double> cosines = {};  ///< of the angles between their axes and that of the moment
  model::Pedestal shaking = {};

  double moment(std::size_t hinge, double t) const { return cosines[hinge] * shaking.moment(t); }  ///< [N m]

  /// Puts the moment into the places of the angles.
  void shake(double t, VectorXd& torques) const {
    for (std::size_t k = 0; k < thetas.size(); ++k) torques[thetas[k]] = moment(k, t);
  }
};

/// A force and a moment at a point: in the base's axes (dead) or in the link's (following).
template <int D>
struct PointLoadIn {
  int point = 0;
  geometry::Point<D> force = geometry::Point<D>::Zero();
  geometry::Turn<D> moment = geometry::Turn<D>::Zero();
  bool follows = false;
};

/// What acts on the arm from outside.
template <int D>
struct LoadsIn {
  geometry::Point<D> gravity = -9.81 * geometry::Point<D>::Unit(D - 1);
  std::vector<PointLoadIn<D>> points;
  VectorXd torques;  ///< on the scalar coordinates, by the motors; empty: none
};

/// Wrench of a point load on its node, in the axes of the node, whose frame is `H`.
template <int D>
geometry::Twist<D> wrench(const PointLoadIn<D>& load, const AttachmentIn<D>& at,
                          const geometry::FrameIn<D>& H);

using PointLoad = PointLoadIn<3>;
using Loads = LoadsIn<3>;

/// Factors of mass, damping and stiffness in a tangent matrix c_M M + c_C C + c_K K.
struct TangentFactors {
  double mass, damping, stiffness;
  double constraint = 1;  ///< scale s of constraints and multipliers: rows s Φ, forces s Φ_qᵀ λ̂
  /// What tables of a joint's state give to links, payloads and the base stays: then K is symmetric.
  bool hold_tables = false;
};

/// Which terms of a tangent are wanted, beside those of mass and constraints, which cost little.
struct WantedTerms {
  bool damping, stiffness;
  bool tables = true;  ///< derivatives of tables of a joint's state, which are 0 where these are held
};

template <int D>
class SystemIn {
 public:
  static constexpr int n = geometry::freedoms<D>;  ///< of a node
  using FrameD = geometry::FrameIn<D>;
  using TwistD = geometry::Twist<D>;
  using TwistMatrixD = geometry::TwistMatrix<D>;
  using StateD = StateIn<D>;
  using LoadsD = LoadsIn<D>;
  using Beam = elements::BeamElementIn<D>;
  using Part = elements::SuperElementIn<D>;
  using Joint = joints::JointConstraintIn<D>;

  int n_nodes() const { return n_nodes_; }
  int n_scalars() const { return static_cast<int>(scalar_inertia_.size()); }
  int n_velocities() const { return n * n_nodes_ + n_scalars(); }
  int n_free() const { return n * n_nodes_ + n_free_scalars_; }
  int n_constraints() const { return n_constraints_; }
  int n_unknowns() const { return n_free() + n_constraints_; }
  int scalar_offset() const { return n * n_nodes_; }
  bool is_free(int scalar) const { return scalar < n_free_scalars_; }
  int first_row(int constraint) const;  ///< of its equations (2); behind the last joint come the gears

  const std::vector<LinkMesh>& meshes() const { return meshes_; }
  const std::vector<Beam>& beams() const { return beams_; }
  /// The same beams as evaluate() takes them: two by two, and those that are left.
  const std::vector<elements::BeamPairIn<D>>& beam_pairs() const { return beam_pairs_; }
  const std::vector<std::size_t>& single_beams() const { return single_beams_; }
  const std::vector<elements::RigidBodyIn<D>>& bodies() const { return bodies_; }
  const std::vector<Part>& superelements() const { return superelements_; }
  const std::vector<elements::WeightIn<D>>& weights() const { return weights_; }  ///< one a node
  const std::vector<double>& scalar_inertia() const { return scalar_inertia_; }   ///< one a scalar coordinate
  const std::vector<Joint>& constraints() const { return constraints_; }
  /// Gears between joints first, each with θ of its input and φ of its output; then the transmissions of
  /// joints, from φ to ψ.
  const std::vector<joints::GearConstraint>& gears() const { return gears_; }
  /// The transmission of a joint; null without one.
  const joints::Transmission* transmission(int joint) const;
  const LoopClosuresIn<D>& closures() const { return closures_; }
  /// Multipliers of the closures.
  Eigen::Ref<const VectorXd> of_closures(const StateD& state) const {
    return state.multipliers.tail(closures_.rows());
  }
  const std::vector<PlacedLaw>& laws() const { return laws_; }
  const std::vector<JointCoordinates>& joints() const { return joint_coordinates_; }
  const std::vector<DriveKind>& drives() const { return drives_; }
  const PedestalCoordinates& pedestal() const { return pedestal_; }
  /// Those of the pedestal first, then those of each joint's mount. Their constraints follow the joints'.
  const std::vector<HingeCoordinates>& hinges() const { return hinges_; }
  const std::vector<AttachmentIn<D>>& points() const { return points_; }
  const std::vector<RestStrainIn<D>>& rest_strains() const { return rest_strains_; }
  const std::vector<StateForceIn<D>>& state_forces() const { return state_forces_; }
  bool has_state_loads() const { return !rest_strains_.empty() || !state_forces_.empty(); }
  double reach() const { return reach_; }  ///< a length of the arm, to scale by [m]
  double mass() const { return mass_; }    ///< of everything [kg]

  /// Left side minus right side of (1) for all velocities, prescribed ones included; `r` has n_velocities()
  /// entries. `friction` leaves out what has no part in statics: laws that only resist motion.
  void residual(const StateD& state, const LoadsD& loads, bool friction, VectorXd& r) const;

  /// The rows of the scalar coordinates without motor torques: what a motor must give. n_scalars() entries.
  void scalar_residual(const StateD& state, bool friction, Eigen::Ref<VectorXd> r) const;

  /// Equation (2).
  void violation(const StateD& state, VectorXd& phi) const;

  /// The second derivative of (2) in time, Φ_q v' + γ, where (2) and its first derivative hold.
  void constraint_acceleration(const StateD& state, VectorXd& c) const;

  /// Both in one pass, with friction, as time stepping asks for them. Joints that are flagged in `left_out`
  /// have no part in it; empty: none.
  void evaluate(const StateD& state, const LoadsD& loads, VectorXd& r, VectorXd& phi,
                const std::vector<bool>& left_out = {}) const;

  /// Tangent of (1), (2) with respect to the unknowns, as triplets in an order that never changes:
  /// add(row, column, value). `law_tangents` are the stiffnesses to use for the laws. This and the next are
  /// defined in tangent_terms.hpp.
  template <class Add>
  void emit_tangent(const StateD& state, const LoadsD& loads, const TangentFactors& c,
                    const VectorXd& law_tangents, Add&& add) const;

  /// What the tangent is made of, in the same order; those that are not wanted are 0.
  template <class Terms>
  void emit_terms(const StateD& state, const LoadsD& loads, WantedTerms wanted, Terms&& terms) const;

  /// The same as a sparse matrix; with `constraints` off only the n_free() x n_free() block.
  Eigen::SparseMatrix<double> tangent(const StateD& state, const LoadsD& loads, const TangentFactors& c,
                                      bool constraints = true) const;

  /// ∂Φ/∂(free velocities).
  Eigen::SparseMatrix<double> constraint_jacobian(const StateD& state) const;

  /// c_K ∂Q/∂x + c_C ∂Q/∂x' of every law at the state, then c_K ∂Q/∂y + c_C ∂Q/∂y' of every law.
  VectorXd law_tangents(const StateD& state, const TangentFactors& c, bool friction) const;
  VectorXd no_law_tangents() const { return VectorXd::Zero(2 * static_cast<Eigen::Index>(laws_.size())); }

  /// Answer of the k-th law, or of another one at its place, in a state whose memories it takes.
  joints::LawResponse respond(std::size_t k, const StateD& state, const joints::JointLaw& law) const;
  joints::LawResponse respond(std::size_t k, const StateD& state) const {
    return respond(k, state, laws_[k].law);
  }
  /// y of a law, and the time.
  joints::LawArgument argument(const PlacedLaw& law, const StateD& state) const;

  double deflection(const PlacedLaw& law, const Eigen::Ref<const VectorXd>& s) const {
    return s[law.plus] - (law.minus < 0 ? 0.0 : s[law.minus]);
  }

  /// The part of a state that a super-element sees, and its velocities (or accelerations) out of all of them.
  typename Part::Configuration configuration(const Part& part, const StateD& state) const;
  VectorXd velocities(const Part& part, const VectorXd& v) const;

  typename Part::Motion motion(const Part& part, const StateD& state) const;

  /// Makes the state the one from which laws with memory count.
  void remember(StateD& state) const;

  /// Frame of a point (link axes there), and its velocity in those axes.
  FrameD point_frame(const StateD& state, int point) const;
  TwistD point_velocity(const StateD& state, int point) const;

 protected:
  template <class Terms>
  void emit_elements(const StateD& state, const LoadsD& loads, WantedTerms wanted, Terms& terms) const;
  template <class Terms>
  void emit_weights(const StateD& state, const LoadsD& loads, WantedTerms wanted, Terms& terms) const;
  template <class Terms>
  void emit_state_loads(const StateD& state, WantedTerms wanted, Terms& terms) const;
  template <class Terms>
  void emit_joints(const StateD& state, WantedTerms wanted, Terms& terms) const;
  template <class Terms>
  void emit_closures(const StateD& state, WantedTerms wanted, Terms& terms) const;
  int row(const Part& part, int k) const;  // of its k-th velocity
  void pair_beams();                       // once they are complete
  void add_masses(const StateD& state, const LoadsD& loads, VectorXd& r) const;
  /// @throws InvalidParameter if there is no such point, or it has no node of its own to be loaded at.
  const AttachmentIn<D>& loaded_point(int point) const;
  const FrameD& frame(const StateD& state, int node) const {
    static const FrameD base;
    return node < 0 ? base : state.frames[node];
  }

  int n_nodes_ = 0, n_free_scalars_ = 0, n_constraints_ = 0;
  double reach_ = 0, mass_ = 0;
  std::vector<LinkMesh> meshes_;
  std::vector<Beam> beams_;
  std::vector<elements::BeamPairIn<D>> beam_pairs_;
  std::vector<std::size_t> single_beams_;
  std::vector<elements::RigidBodyIn<D>> bodies_;
  std::vector<Part> superelements_;
  std::vector<elements::WeightIn<D>> weights_;  // one a node
  std::vector<Joint> constraints_;
  std::vector<joints::GearConstraint> gears_;
  LoopClosuresIn<D> closures_;
  std::vector<PlacedLaw> laws_;
  std::vector<JointCoordinates> joint_coordinates_;
  PedestalCoordinates pedestal_;
  std::vector<HingeCoordinates> hinges_;
  std::vector<DriveKind> drives_;
  std::vector<double> scalar_inertia_;
  std::vector<AttachmentIn<D>> points_;
  std::vector<RestStrainIn<D>> rest_strains_;
  std::vector<StateForceIn<D>> state_forces_;
};

}  // namespace flexarm::assembly
