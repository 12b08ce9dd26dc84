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
/// (integrators/woodbury_update.hpp). Teeth that meet and friction that turns so cost no further iterates.
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
#include "flexarm/integrators/step_solver.hpp"

namespace flexarm::integrators {

/// What drives the arm at one instant: prescribed scalar coordinates with their derivatives, and motor
/// torques.
struct DriveValues {
  VectorXd s, v, v_dot;  ///< n_scalars() each; entries of free coordinates are not read
  VectorXd torques;      ///< n_scalars()
};

/// Writes the drive values at time t.
using Drives = std::function<void(double t, DriveValues& values)>;

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
using StepObserverIn = std::function<void(const StateIn<D>& before, const StateIn<D>& after,
                                          const VectorXd& exponent, double h, const LoadsIn<D>& loads)>;
using StepObserver = StepObserverIn<3>;

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
  void observe_with(StepObserverIn<D> observer) { observer_ = std::move(observer); }

  /// Loads that act from now on, beside gravity and motors.
  void set_point_loads(const std::vector<assembly::PointLoadIn<D>>& points) { loads_.points = points; }

  /// Forces of the welded joints in a state that was reached.
  void recover_multipliers(StateIn<D>& state) const {
    solver_.condensation().recover_multipliers(state, loads_);
  }

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
  void correct(StateIn<D>& state, const VectorXd& delta, double h);
  bool factor(const StateIn<D>& state, double h);
  void place(StateIn<D>& state) const;
  void halve(StateIn<D>& state, double h, const Drives& drives, int depth);

  const SystemIn<D>& system_;
  HhtCoefficients coefficients_;
  LoadsIn<D> loads_;
  HhtOptions options_;
  HhtStatistics statistics_;

  StepSolverIn<D> solver_;
  int iteration_ = 0;  // the last one made
  HhtMemoryIn<D> memory_;

  StateIn<D> before_;  // state 0
  VectorXd exponent_;  // argument of exp in (3), and scalar increments
  VectorXd r_, phi_;
  DriveValues drive_;
  StepObserverIn<D> observer_;
};

using HhtStepper = HhtStepperIn<3>;

}  // namespace flexarm::integrators
