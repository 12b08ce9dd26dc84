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
/// Internal forces are those of the positions and stay as they are. With the derivative of r as zero and M
/// constant, derivatives by a parameter p follow from
///
///     A d(w − v̇, λ̃ − λ)/dp = −(dM/dp (w − v̇) + d/dp [Φ_qᵀ] (λ̃ − λ), d/dp [Φ_q] w + dγ/dp)            (4)
///
/// whose total derivatives d/dp of constraints are differences of the two models of p.
/// `TransientOptions::consistent_forces` leaves it out.
///
/// One factorisation A₀ serves (2) while the arm moves. Where integrators/woodbury_update.hpp does not follow
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
#include "flexarm/integrators/woodbury_update.hpp"
#include "flexarm/linear_solvers/cached_factorisation.hpp"
#include "flexarm/linear_solvers/packed_matrix.hpp"
#include "flexarm/simulation/variation.hpp"

namespace flexarm::simulation {

/// Coordinates without mass get this part of the largest one: they take next to no force, and (2) stays
/// regular.
constexpr double nearly_massless = 1e-12;

template <int D>
class ConsistentForcesIn {
 public:
  /// @param most_joints that are followed, integrators/woodbury_update.hpp
  explicit ConsistentForcesIn(const assembly::SystemIn<D>& system,
                              std::size_t most_joints = integrators::WoodburyUpdateIn<D>::most_in_steps);

  /// The state with w and λ̃ of (1); `state` itself where they are v̇ and λ. The result lasts until the next
  /// call. @param loads of the step; null: r is taken as zero, as it is where every joint is followed
  /// @throws NotConverged if the matrix of (2) is singular.
  const assembly::StateIn<D>& of(const assembly::StateIn<D>& state,
                                 const assembly::LoadsIn<D>* loads = nullptr);

  /// (w − v̇, (λ̃ − λ)/s) of the last call.
  const VectorXd& change() const { return change_; }
  double scale() const { return scale_; }  ///< s of multipliers and constraints
  const integrators::WoodburyUpdateIn<D>& update() const { return update_; }  ///< of A₀
  /// x := the solution of (2) in `state`, of which the last call of of() was made, for the right side x.
  void solve(const assembly::StateIn<D>& state, VectorXd& x);

 private:
  void find_masses(const assembly::StateIn<D>& state);
  void find_sides(const assembly::StateIn<D>& state, const assembly::LoadsIn<D>* loads);
  void factor(const assembly::StateIn<D>& state);
  void substitute(const assembly::StateIn<D>& state, VectorXd& x, bool again = false);
  bool refine(const assembly::StateIn<D>& state, const VectorXd& b, VectorXd& x);
  void multiply(assembly::StateIn<D>& still, const VectorXd& x, VectorXd& product);

  const assembly::SystemIn<D>& system_;
  double scale_;
  assembly::IterationMatrixIn<D> matrix_;
  Eigen::SparseMatrix<double> regular_;
  Eigen::SparseMatrix<double> massless_;                 // what coordinates without mass get
  Eigen::SparseMatrix<double> mass_;                     // with it
  const integrators::RigidJointCondensationIn<D> none_;  // rigid joints have their multipliers
  integrators::WoodburyUpdateIn<D> update_;
  bool factored_ = false;
  linear_solvers::CachedFactorisation kept_;
  linear_solvers::PackedMatrix by_constraints_;  // −s A₀⁻¹ [0; I], where A₀ is small
  VectorXd padded_;
  VectorXd c_, change_, r_, phi_, multipliers_;
  assembly::StateIn<D> consistent_, still_;
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
  void find_mass_slopes(const assembly::StateIn<D>& state);
  void move(const assembly::StateIn<D>& state, const StateDerivative& derivative, Eigen::Index k,
            double amount, assembly::StateIn<D>& there) const;
  void constrain(const assembly::SystemIn<D>& model, const assembly::StateIn<D>& state, double factor,
                 VectorXd& x);

  const assembly::SystemIn<D>& system_;
  const std::vector<VariationIn<D>> variations_;
  const std::vector<int> nodes_;  // of the constraints
  ConsistentForcesIn<D> forces_;
  std::vector<Eigen::SparseMatrix<double>> mass_slopes_;  // dM/dp, free rows
  VectorXd multipliers_;                                  // λ̃ − λ
  VectorXd r_, c_, x_;
  assembly::StateIn<D> moved_;
  const assembly::StateIn<D>* state_ = nullptr;
  StateDerivative derivative_;
};

using ConsistentForces = ConsistentForcesIn<3>;

}  // namespace flexarm::simulation
