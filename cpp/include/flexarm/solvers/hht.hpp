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
/// contracts. The tangents of joint laws (friction) that do change enter by the Woodbury identity,
/// with one kept solve a law.
///
/// The iteration stops when the error left, estimated from the contraction as in [HairerWanner1996], is below
/// two tolerances: one for positions, and one for accelerations, to which an error δ of a position
/// contributes δ/(β h²). What is left over does not add up in positions, for every step restores equilibrium
/// (1) by itself. Units: SI, h in s. docs/theory.md, section "Time stepping".
#pragma once

#include <functional>
#include <memory>

#include "flexarm/assembly/iteration_matrix.hpp"
#include "flexarm/assembly/system.hpp"
#include "flexarm/solvers/sparse_factor.hpp"

namespace flexarm::solvers {

using assembly::Loads;
using assembly::State;
using assembly::System;
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
};

/// Where factors were made.
struct Linearisation {
  State state;
  Loads loads;
  double h = 0;
};

/// What a stepper carries from one step to the next beside the state. A reproducible stepper that recalls it
/// makes the same step to the last bit, whatever it did in between, and so does another one.
struct HhtMemory {
  std::shared_ptr<const Linearisation> factored;  ///< null: no factors yet
  double contraction = 0.5;  ///< of the last steps, for the first iterate's error estimate
  long steps = 0;            ///< accepted so far
};

/// Told of every accepted step: states 0 and 1, the argument of exp in (3), its size and the loads at its
/// end.
using Follower = std::function<void(const State& before, const State& after, const VectorXd& exponent,
                                    double h, const Loads& loads)>;

/// Counts of a run.
struct HhtStatistics {
  long steps = 0, iterations = 0, factorisations = 0, halvings = 0;
};

class HhtStepper {
 public:
  HhtStepper(const System& system, const HhtCoefficients& coefficients, const Loads& loads,
             HhtOptions options = {});

  /// One step of size h; halved where Newton's iteration fails.
  /// @throws NotConverged naming time, iteration and residual; the state is then as before.
  void advance(State& state, double h, const Drives& drives);

  /// Lets somebody walk along; steps that are halved are told half by half.
  void follow_with(Follower follower) { follower_ = std::move(follower); }

  /// Loads that act from now on, beside gravity and motors.
  void set_point_loads(const std::vector<assembly::PointLoad>& points) { loads_.points = points; }

  /// @throws NotConverged if the factors cannot be made again.
  void recall(const HhtMemory& memory);
  HhtMemory memory() const;

  const HhtStatistics& statistics() const { return statistics_; }
  /// Motor torques in the state last reached were part of the loads; needed to evaluate forces there.
  const Loads& loads() const { return loads_; }

 private:
  bool step(State& state, double h, const Drives& drives);
  bool iterate(State& state, double h);
  void predict(double h);
  void configure(State& state, double h) const;
  bool factor(const State& state, double h);
  void solve(const State& state, double h);
  void halve(State& state, double h, const Drives& drives, int depth);

  const System& system_;
  HhtCoefficients coefficients_;
  Loads loads_;
  HhtOptions options_;
  HhtStatistics statistics_;

  assembly::IterationMatrix matrix_;
  SparseFactor factor_;
  double factored_h_ = 0;  // step for which the factors hold; 0: none
  HhtMemory memory_;
  double mass_scale_;

  State before_;       // state 0
  VectorXd exponent_;  // argument of exp in (3), and scalar increments
  VectorXd r_, phi_, dx_;
  VectorXd kept_tangents_;         // of the laws, in the factors
  Eigen::MatrixXd law_solutions_;  // S⁻¹ times each law's direction
  DriveValues drive_;
  Follower follower_;
};

}  // namespace flexarm::solvers
