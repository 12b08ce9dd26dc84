/// @file
/// Hilber-Hughes-Taylor (HHT) stepping on a Lie group, in generalised-alpha form, from state 0 to state 1:
///
///     r(H₁, v₁, v̇₁, λ₁) = 0,  Φ(H₁) = 0                              (1)  equilibrium at the end of the step
///     a₁ = (1 + α) v̇₁ − α v̇₀                                         (2)  algorithmic acceleration
///     H₁ = H₀ exp(h v₀ + h² [(½ − β) a₀ + β a₁])                      (3)
///     v₁ = v₀ + h [(1 − γ) a₀ + γ a₁]                                 (4)
///
/// with β = (1 − α)²/4, γ = ½ − α: of the family of [Chung1993] and [Bruls2012] the member α_m = 0, α_f = −α.
/// It is of order two in positions, velocities and multipliers and damps the highest frequencies by the
/// spectral radius (1 + α)/(1 − α) a step. An iterate corrects the argument of exp in (3) by
///
///     S Δ = −(r, s Φ),   S = [M/(β h² (1 + α)) + γ/(β h) C + K,  s Φ_qᵀ;  s Φ_q, 0]                   (5)
///
/// with constraints scaled by s = m/(β h²) so that conditioning does not depend on the step [Bottasso2008].
/// In local frames S hardly changes while the arm swings, so its factors are kept as long as the iteration
/// contracts. What else changes has few directions: angles between links, and joint laws that are not linear
/// (friction, backlash), which every correction follows as they are, not by their tangents
/// (solvers/tangent_changes.hpp). Teeth that meet and friction that turns so cost no further iterates.
///
/// The iteration stops when the error left, estimated from the contraction as in [HairerWanner1996], is below
/// two tolerances: one for positions, and one for accelerations, to which an error δ of a position
/// contributes δ/(β h²). What is left over does not add up in positions, for every step restores equilibrium
/// (1) by itself; in accelerations of constrained nodes it is forgotten by the spectral radius, so that with
/// α = 0 the iteration goes on to rounding. Units: SI, h in s. docs/theory.md, section "Time stepping".
#pragma once

#include <functional>
#include <memory>

#include "flexarm/assembly/equations.hpp"
#include "flexarm/assembly/iteration_matrix.hpp"
#include "flexarm/solvers/kept_factor.hpp"
#include "flexarm/solvers/tangent_changes.hpp"
#include "flexarm/solvers/welds.hpp"

namespace flexarm::solvers {

using assembly::LoadsIn;
using assembly::StateIn;
using assembly::SystemIn;
using Eigen::VectorXd;

/// Coefficients of (2)-(4). α = 0 is the trapezoidal rule, α = −1/3 damps most.
struct HhtCoefficients {
  double alpha, beta, gamma;

  /// @throws InvalidParameter if α lies outside [−1/3, 0].
  static HhtCoefficients from_alpha(double alpha);
  /// α = (ρ − 1)/(ρ + 1), with ρ in [½, 1] the spectral radius as h → ∞.
  static HhtCoefficients from_spectral_radius(double rho);
  double spectral_radius() const { return (1 + alpha) / (1 - alpha); }
};

/// The shortest time step [s]. Sound passes 5 µm of steel in it, far less than a finite element; much below
/// it 1/(β h²) overflows.
constexpr double shortest_step = 1e-9;

/// @throws InvalidParameter unless a step is finite and at least shortest_step.
void check_step(double h);

/// What drives the arm at one instant: prescribed scalar coordinates with their derivatives, and motor
/// torques.
struct DriveValues {
  VectorXd s, v, v_dot;  ///< n_scalars() each; entries of free coordinates are not read
  VectorXd torques;      ///< n_scalars()
};

/// Writes the drive values at time t.
using Drives = std::function<void(double t, DriveValues& values)>;

struct HhtOptions {
  double tolerance = 1e-10;              ///< of positions, in parts of the reach and rad
  double acceleration_tolerance = 1e-5;  ///< of accelerations, in parts of the reach and rad [1/s²]
  int max_iterations = 12;               ///< before new factors, or a smaller step
  int max_halvings = 8;
  double slow_contraction = 0.25;  ///< above this rate the matrix is factored anew
  bool reproducible = false;       ///< see HhtMemory; factoring then costs an analysis of the pattern too
  bool weld = false;  ///< rigid joints make one node of two (welds.hpp); their forces wait for find_forces()
};

/// Where factors were made.
template <int D>
struct LinearisationIn {
  StateIn<D> state;
  LoadsIn<D> loads;
  double h = 0;
};
using Linearisation = LinearisationIn<3>;

/// What a stepper carries from one step to the next beside the state. A reproducible stepper that recalls it
/// makes the same step to the last bit, whatever it did in between, and so does another one.
template <int D>
struct HhtMemoryIn {
  std::shared_ptr<const LinearisationIn<D>> factored;  ///< null: no factors yet
  double contraction = 0.5;  ///< of the last steps, for the first iterate's error estimate
  long steps = 0;            ///< accepted so far
};
using HhtMemory = HhtMemoryIn<3>;

/// Told of every accepted step: states 0 and 1, the argument of exp in (3), its size and the loads at its
/// end.
template <int D>
using FollowerIn = std::function<void(const StateIn<D>& before, const StateIn<D>& after,
                                      const VectorXd& exponent, double h, const LoadsIn<D>& loads)>;
using Follower = FollowerIn<3>;

/// Counts of a run.
struct HhtStatistics {
  long steps = 0, iterations = 0, factorisations = 0, halvings = 0;
};

template <int D>
class HhtStepperIn {
 public:
  HhtStepperIn(const SystemIn<D>& system, const HhtCoefficients& coefficients, const LoadsIn<D>& loads,
               HhtOptions options = {});

  /// One step of size h; halved where Newton's iteration fails.
  /// @throws NotConverged naming time, iteration and residual; the state is then as before.
  void advance(StateIn<D>& state, double h, const Drives& drives);

  /// Lets somebody walk along; steps that are halved are told half by half.
  void follow_with(FollowerIn<D> follower) { follower_ = std::move(follower); }

  /// Loads that act from now on, beside gravity and motors.
  void set_point_loads(const std::vector<assembly::PointLoadIn<D>>& points) { loads_.points = points; }

  /// Forces of the welded joints in a state that was reached.
  void find_forces(StateIn<D>& state) const { welds_.find_forces(state, loads_); }

  /// @throws NotConverged if the factors cannot be made again.
  void recall(const HhtMemoryIn<D>& memory);
  HhtMemoryIn<D> memory() const;

  const HhtStatistics& statistics() const { return statistics_; }
  /// Motor torques in the state last reached were part of the loads; needed to evaluate forces there.
  const LoadsIn<D>& loads() const { return loads_; }

 private:
  bool step(StateIn<D>& state, double h, const Drives& drives);
  void set_aside(StateIn<D>& state);
  bool iterate(StateIn<D>& state, double h);
  void predict(StateIn<D>& state, double h);
  void correct(StateIn<D>& state, double h);
  void place(StateIn<D>& state) const;
  bool factor(const StateIn<D>& state, double h);
  void solve(const StateIn<D>& state, double h, bool again);
  void halve(StateIn<D>& state, double h, const Drives& drives, int depth);

  const SystemIn<D>& system_;
  HhtCoefficients coefficients_;
  LoadsIn<D> loads_;
  HhtOptions options_;
  HhtStatistics statistics_;

  assembly::IterationMatrixIn<D> matrix_;
  KeptFactor factor_;
  double factored_h_ = 0;  // step for which the factors hold; 0: none
  bool singular_ = false;  // the matrix of the last attempt to factor
  int iteration_ = 0;      // the last one made
  HhtMemoryIn<D> memory_;
  double mass_scale_;

  StateIn<D> before_;  // state 0
  VectorXd exponent_;  // argument of exp in (3), and scalar increments
  VectorXd r_, phi_, dx_;
  WeldsIn<D> welds_;
  VectorXd reduced_;  // y of welds.hpp
  TangentChangesIn<D> changes_;
  DriveValues drive_;
  FollowerIn<D> follower_;
};

using HhtStepper = HhtStepperIn<3>;

}  // namespace flexarm::solvers
