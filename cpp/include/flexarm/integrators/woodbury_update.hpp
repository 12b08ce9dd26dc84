/// @file
/// Woodbury update of a cached factorisation of the iteration matrix: while an arm moves the matrix changes
/// in few directions, and few forces change.
///
///     S Δ = b,  S = S₀ + U C Uᵀ:   Δ = x − W f,  x = S₀⁻¹ b,  W = S₀⁻¹ U,  f = C Uᵀ Δ                (1)
///
/// A joint between two links that move turns one link's axes against the other's: of its constraint (eq. (2)
/// of joints/joint_constraint.hpp) Φ_a = −Ad(exp(−ξ θ)) Ad_a follows θ. Only directions across the joint's
/// axis turn; with P a base of those of the multipliers and Q of the twists, s the scale of the constraints,
/// and e_a, e_λ the places of the parent's node and of the multipliers,
///
///     U_J = [e_a Ad_aᵀ Q,  e_λ P],   C = [0  Eᵀ; E  0],   E = −s (T(θ) − T(θ₀))                       (2)
///
/// where Ad(exp(−ξ θ)) = P T Qᵀ and what stays. In space P = Q are translations and rotations across the
/// axis, with J = [0 1; −1 0]
///
///     revolute: T = diag(t, t), t = cos θ I + sin θ J          prismatic: T = [I  θ J; 0  I]         (3)
///
/// In the plane a hinge turns the two translations by t, a slide moves P = J ξ by −θ with a turn of the
/// parent. A pin that closes a loop in the plane turns the translations of its node b by T = −R
/// (joints/closure_constraint.hpp), and one that lets nothing move changes nothing.
///
/// Without (2) the iteration of an arm with an inner hinge contracts by some 0.3 a radian that the hinge has
/// turned since the factors were made. A joint on the base has no such term.
///
/// A joint law between two scalar coordinates has one column u and one force f, which is not C times its
/// deflection but follows the law itself (q of integrators/law_equations.hpp):
///
///     u = e₊ − e₋,   f_L = q(u·Δ)                                                                    (4)
///
/// With G = Uᵀ W, the forces of the joints are linear in those of the laws, which leaves equations in the
/// laws' deflections alone, w + Ĝ f_L = z:
///
///     (I + C G_JJ) f_J = C (U_Jᵀ x − G_JL f_L)                                                       (5)
///     Ĝ = G_LL − G_LJ (I + C G_JJ)⁻¹ C G_JL,   z = U_Lᵀ x − G_LJ (I + C G_JJ)⁻¹ C U_Jᵀ x            (6)
///
/// Within a step joints turn by what a prediction misses, some 1e-5 rad: of the first of its corrections I +
/// C G_JJ, its factors and Ĝ serve for all of them.
///
/// Sources: [Hager1989] for (1); docs/theory.md, section "Time stepping".
#pragma once

#include <Eigen/Core>
#include <vector>

#include "flexarm/assembly/equations.hpp"
#include "flexarm/integrators/law_equations.hpp"
#include "flexarm/integrators/rigid_joint_condensation.hpp"
#include "flexarm/integrators/turned.hpp"
#include "flexarm/linear_solvers/elimination.hpp"
#include "flexarm/linear_solvers/packed_matrix.hpp"
#include "flexarm/linear_solvers/sparse_factor.hpp"

namespace flexarm::integrators {

template <int D>
class WoodburyUpdateIn {
 public:
  // More turning joints than this make (1) dearer than the iterations it saves.
  static constexpr int most_in_steps = 3;

  /// @param condensation the unknowns that S has. @param laws whether S has the laws' tangents.
  /// @param most_joints up to so many turning joints are followed
  WoodburyUpdateIn(const assembly::SystemIn<D>& system, const RigidJointCondensationIn<D>& condensation,
                   bool laws = true, std::size_t most_joints = most_in_steps);

  /// Whether (1) follows every change of Φ_q.
  bool follows_constraints() const { return follows_constraints_; }
  /// Whether there is something to follow.
  bool any() const { return W_.cols() > 0; }

  /// S₀ has been factored in this state. @param c factors of the tangent, @param laws tangents in S₀.
  void keep(const assembly::StateIn<D>& state, const assembly::TangentFactors& c, const Eigen::VectorXd& laws,
            const linear_solvers::SparseFactor& factor);

  /// Equation (1): S₀⁻¹ b becomes what turned joints and all of the laws make of it.
  /// @param again whether joints have hardly turned since the correction before, with factors as they were
  void correct(const assembly::StateIn<D>& state, Eigen::VectorXd& x, bool again = false);

  /// The two parts of it: C of this state. @return whether anything has changed
  bool prepare(const assembly::StateIn<D>& state, bool again);
  /// f of (1). @param along Uᵀ x
  const Eigen::VectorXd& forces(const assembly::StateIn<D>& state, const Eigen::VectorXd& along);

  static constexpr int n = geometry::freedoms<D>, across = across_joint<D>;
  static constexpr int rows = rows_across<D>;

  struct TurningJoint {
    int constraint, closure;  // one of them, the other is −1
    int first_row, node_row;  // of the multipliers, of the parent's node or its carrier
    Eigen::Matrix<double, rows, across> P;
    Eigen::Matrix<double, n, across> on_parent;  // Ad_aᵀ Q
    Turned<D> kept = Turned<D>::Zero();          // T(θ₀)
  };

  /// What lanes/turn_numbers.hpp needs for (5).
  const assembly::SystemIn<D>& system() const { return system_; }
  const std::vector<TurningJoint>& joints() const { return joints_; }
  const Eigen::MatrixXd& W() const { return W_; }
  const Eigen::MatrixXd& G() const { return G_; }
  double scale() const { return factors_.constraint; }     ///< s of (2)
  Eigen::VectorXd along(const Eigen::VectorXd& x) const {  ///< Uᵀ x
    Eigen::VectorXd Ux(W_.cols());
    find_along([&](int row) { return x[row]; }, Ux);
    return Ux;
  }
  /// The same of entries x(row).
  template <class Entries>
  void find_along(const Entries& x, Eigen::VectorXd& Ux) const {
    const auto part = [&]<int size>(int first, std::integral_constant<int, size>) {
      Eigen::Matrix<double, size, 1> found;
      for (int i = 0; i < size; ++i) found[i] = x(first + i);
      return found;
    };
    constexpr std::integral_constant<int, n> of_node;
    constexpr std::integral_constant<int, rows> of_row;
    Eigen::Index at = 0;
    for (const TurningJoint& joint : joints_) {
      Ux.template segment<across>(at) = joint.on_parent.transpose() * part(joint.node_row, of_node);
      Ux.template segment<across>(at + across) = joint.P.transpose() * part(joint.first_row, of_row);
      at += 2 * across;
    }
    const auto entry = [&](int row) { return row >= 0 ? x(row) : 0.0; };
    for (int k : laws_) Ux[at++] = entry(law_rows_[k].plus) - entry(law_rows_[k].minus);  // eq. (4)
  }

 private:
  /// Rows of u in (4); none where a coordinate is prescribed.
  struct LawRows {
    int plus, minus;
  };

  void find_turning_joints(const RigidJointCondensationIn<D>& condensation, std::size_t most);
  void find_laws(const RigidJointCondensationIn<D>& condensation);
  void find_turning_pins(const RigidJointCondensationIn<D>& condensation);
  Turned<D> turned_by(const TurningJoint& joint, const assembly::StateIn<D>& state) const;  // T
  bool turn_joints(const assembly::StateIn<D>& state);
  void find_laws_here(const assembly::StateIn<D>& state);
  void directions(Eigen::MatrixXd& U) const;

  /// What depends on the turns of the joints alone, and the forces, for numbers of joints and laws; the
  /// former is Eigen::Dynamic for more than most_in_steps.
  struct ForNumbers {
    void (WoodburyUpdateIn::*prepare)();
    void (WoodburyUpdateIn::*find_joint_forces)(const Eigen::VectorXd&);
    void (WoodburyUpdateIn::*add_law_forces)(const Eigen::VectorXd&);
  };
  static ForNumbers for_numbers(std::size_t joints, std::size_t laws);
  template <int joints>
  static constexpr int columns_of = joints < 0 ? Eigen::Dynamic : 2 * across * joints;
  template <int joints>
  void prepare_for();
  template <int joints>
  void find_joint_forces(const Eigen::VectorXd& x);
  template <int L, int most>
  void add_law_forces(const Eigen::VectorXd& x);

  const assembly::SystemIn<D>& system_;
  std::vector<TurningJoint> joints_;
  std::vector<int> laws_;  // that are not linear
  std::vector<LawHere> laws_here_;
  ForNumbers for_numbers_;
  std::vector<LawRows> law_rows_;  // of all laws
  assembly::TangentFactors factors_{};
  Eigen::VectorXd kept_laws_;
  Eigen::MatrixXd W_, G_, C_;  // G = Uᵀ W
  bool follows_constraints_;
  bool turned_ = false;             // whether C is not zero
  Eigen::MatrixXd LU_, C_G_, G_l_;  // of I + C G_JJ, by rows; (I + C G_JJ)⁻¹ C G_JL; Ĝ
  linear_solvers::Pivots<Eigen::Dynamic> pivots_;
  linear_solvers::PackedMatrix packed_W_;
  Eigen::VectorXd f_, Wy_, Ux_;
};

}  // namespace flexarm::integrators
