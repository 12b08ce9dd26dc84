/// @file
/// Forces of a state whose accelerations satisfy the constraints.
///
/// Time stepping solves r(H, v, v̇, λ) = 0 and Φ(H) = 0 at the end of a step. Its accelerations of constrained
/// nodes are differences of positions, with errors of first order after every jump of a drive's acceleration
/// or jerk; they decay by the spectral radius, and with α = 0 not at all. So do the multipliers λ, and both
/// take up what Newton's iteration leaves of r. At the same positions and velocities w and λ̃ are those of
/// the equations of motion and the second derivative of Φ,
///
///     r(H, v, w, λ̃) = 0,   Φ_q w + γ(H, v) = 0                                                       (1)
///
/// of the order of positions and velocities, and without memory: with c = Φ_q v̇ + γ
///
///     A (w − v̇, λ̃ − λ) = −(r, c),   A = [M  Φ_qᵀ; Φ_q  0]                                            (2)
///
/// Internal forces are those of the positions and stay as they are. Derivatives by a parameter follow from
/// the difference of (2) in its two models, with the derivative of r as zero.
/// `TransientOptions::consistent_forces` leaves it out.
///
/// One factorisation A₀ serves (2) while the arm moves. Where solvers/tangent_changes.hpp does not follow
/// every turned joint, r is more than rounding, and the solution is refined [Golub2013],
///
///     x ← x + A₀⁻¹ (b − A x)                                                                         (3)
///
/// and A₀ is made anew where that contracts slowly.
/// Sources: [Geradin2001], [Arnold2015], [Golub2013]; docs/theory.md, section "Time stepping".
#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "flexarm/assembly/iteration_matrix.hpp"
#include "flexarm/simulation/variation.hpp"
#include "flexarm/solvers/kept_factor.hpp"
#include "flexarm/solvers/tangent_changes.hpp"

namespace flexarm::simulation {

/// Coordinates without mass get this part of the largest one: they take next to no force, and (2) stays
/// regular.
constexpr double nearly_massless = 1e-12;

template <int D>
class ConsistentForcesIn {
 public:
  explicit ConsistentForcesIn(const assembly::SystemIn<D>& system);

  /// The state with w and λ̃ of (1); `state` itself where they are v̇ and λ. The result lasts until the next
  /// call. @param loads of the step; null: r is taken as zero, as it is where every joint is followed
  /// @throws NotConverged if the matrix of (2) is singular.
  const assembly::StateIn<D>& of(const assembly::StateIn<D>& state,
                                 const assembly::LoadsIn<D>* loads = nullptr);

  /// (w − v̇, (λ̃ − λ)/s) of the last call.
  const VectorXd& change() const { return change_; }
  double scale() const { return scale_; }  ///< s of multipliers and constraints
  const solvers::TangentChangesIn<D>& changes() const { return changes_; }  ///< of A₀
  /// x := the solution of (2) in `state`, of which the last call of of() was made, for the right side x.
  void solve(const assembly::StateIn<D>& state, VectorXd& x);

 private:
  void find_massless(const assembly::StateIn<D>& state);
  void factor(const assembly::StateIn<D>& state);
  void substitute(const assembly::StateIn<D>& state, VectorXd& x, bool again = false);
  bool refine(const assembly::StateIn<D>& state, const VectorXd& b, VectorXd& x);
  void evaluate(const assembly::StateIn<D>& state, VectorXd& sides);

  const assembly::SystemIn<D>& system_;
  double scale_;
  assembly::IterationMatrixIn<D> matrix_;
  Eigen::SparseMatrix<double> regular_;
  Eigen::SparseMatrix<double> massless_;  // what coordinates without mass get
  const solvers::WeldsIn<D> none_;        // rigid joints have their multipliers
  solvers::TangentChangesIn<D> changes_;
  bool factored_ = false;
  solvers::KeptFactor kept_;
  VectorXd c_, change_, r_, phi_;
  assembly::StateIn<D> consistent_, moved_;
};

/// The same, and derivatives of w and λ̃ with respect to parameters.
template <int D>
class ConsistentForceSlopesIn {
 public:
  ConsistentForceSlopesIn(const assembly::SystemIn<D>& system, const std::vector<VariationIn<D>>& variations);

  /// Makes state() and derivative() of a state of the time stepping and its derivative.
  void find(const assembly::StateIn<D>& state, const assembly::LoadsIn<D>& loads,
            const StateDerivative& derivative);

  const assembly::StateIn<D>& state() const { return *state_; }
  const StateDerivative& derivative() const { return derivative_; }

 private:
  /// The left side of (2) times its solution, and c, in one of the models.
  VectorXd evaluate(const assembly::SystemIn<D>& model, assembly::StateIn<D> state);

  const assembly::SystemIn<D>& system_;
  const std::vector<VariationIn<D>> variations_;
  ConsistentForcesIn<D> forces_;
  VectorXd with_, without_, phi_, c_;
  const assembly::StateIn<D>* state_ = nullptr;
  StateDerivative derivative_;
};

using ConsistentForces = ConsistentForcesIn<3>;

}  // namespace flexarm::simulation
