/// @file
/// Derivatives of a run with respect to parameters, by direct differentiation of every HHT step.
///
/// A step of integrators/hht.hpp takes state 0 to state 1. Let ξ be the twist by which a frame moves with the
/// parameter p, H⁻¹ dH/dp (for scalar coordinates ds/dp), h the argument of exp, and T_r, T_l its tangent
/// operators. Differentiation of the step gives
///
///     ξ₁ = T_r(h) dh/dp + Ad(exp(−h)) ξ₀      hence  dh/dp = T_r⁻¹ ξ₁ − T_l⁻¹ ξ₀                    (1)
///     da₁ = (dh/dp − h dv₀)/(β h²) − (½ − β)/β da₀                                                    (2)
///     dv₁ = dv₀ + h [(1 − γ) da₀ + γ da₁],   dv̇₁ = (da₁ + α dv̇₀)/(1 + α)                             (3)
///     K ξ₁ + C dv₁ + M dv̇₁ + Φ_qᵀ dλ₁ = −∂r/∂p + dτ/dp,   Φ_q ξ₁ = −∂Φ/∂p                            (4)
///
/// a linear problem for (ξ₁, dλ₁) with the exact tangent at state 1,
///
///     S = K + [γ/(β h) C + M/(β h² (1 + α))] T_r⁻¹(h),                                                (5)
///
/// factored once a step for all parameters together; step_slopes.hpp makes (1) to (3) and (5). ∂r/∂p, at
/// fixed free coordinates, is that of partial_residuals.hpp; prescribed coordinates and the memories of joint
/// laws move along in it. dτ/dp is that of motor torques which somebody holds who looks at the arm, a sampled
/// controller. What comes out is the derivative of the discrete motion, not of the exact one: it
/// agrees with differences of whole runs to their own accuracy. Source: [Bruls2008]; docs/theory.md, section
/// "Sensitivities".
#pragma once

#include <vector>

#include "flexarm/assembly/tangent_parts.hpp"
#include "flexarm/integrators/hht.hpp"
#include "flexarm/linear_solvers/sparse_factor.hpp"
#include "flexarm/sensitivity/law_slopes.hpp"
#include "flexarm/sensitivity/partial_residuals.hpp"
#include "flexarm/sensitivity/step_slopes.hpp"
#include "flexarm/simulation/statics.hpp"
#include "flexarm/simulation/variation.hpp"

namespace flexarm::sensitivity {

using assembly::System;
using Eigen::VectorXd;
using simulation::Equilibrium;
using simulation::Slopes;
using simulation::StateDerivative;
using simulation::Variation;
using simulation::VariationIn;

/// Derivative of an equilibrium at rest, drives held or moved as the variations say:
/// K ξ + Φ_qᵀ dλ = −∂r/∂p, Φ_q ξ = −∂Φ/∂p with the tangent of statics.hpp.
/// @throws NotConverged if the tangent is singular.
StateDerivative static_derivative(const System& system, const Equilibrium& equilibrium,
                                  const std::vector<Variation>& variations);

/// That derivative for the same arm with some of its motors let go; see `released` of sampled_run.hpp.
StateDerivative released(const System& held, const StateDerivative& derivative, const System& system);

/// Walks beside an HhtStepper and differentiates each step that it has taken.
template <int D>
class SensitivitiesIn {
 public:
  using SystemD = assembly::SystemIn<D>;
  using StateD = assembly::StateIn<D>;
  using LoadsD = assembly::LoadsIn<D>;

  SensitivitiesIn(const SystemD& system, const integrators::HhtCoefficients& coefficients,
                  std::vector<VariationIn<D>> variations, StateDerivative initial);
  SensitivitiesIn(const SensitivitiesIn&) = delete;  // its parts refer to one another
  SensitivitiesIn& operator=(const SensitivitiesIn&) = delete;

  /// State 1 from state 0 by an accepted step of size h, with the argument `exponent` of exp in it.
  /// @throws NotConverged if the tangent is singular.
  void follow(const StateD& before, const StateD& after, const VectorXd& exponent, double h,
              const LoadsD& loads);

  /// dτ/dp of (4) from now on, one row a scalar coordinate, one column a parameter; zero until then.
  void hold(const Slopes& torques) { torques_ = torques; }

  /// The derivative of the state from which the next step goes on.
  void go_on_from(StateDerivative now) { before_ = now_ = std::move(now); }

  const std::vector<VariationIn<D>>& variations() const { return variations_; }
  const StateDerivative& derivative() const { return now_; }

 private:
  void add_torques();
  void factor();
  void remember();

  const SystemD& system_;
  integrators::HhtCoefficients coefficients_;
  std::vector<VariationIn<D>> variations_;
  LawSlopesIn<D> laws_;
  PartialResidualsIn<D> partial_;
  StateDerivative now_, before_;
  StateD state_;  // state 1 with the memories of state 0
  assembly::TangentPartsIn<D> parts_;
  Eigen::SparseMatrix<double> S_;
  linear_solvers::SparseFactor factor_;
  StepSlopesIn<D> step_;
  Slopes torques_;                  // dτ/dp of (4); empty: zero
  Slopes rhs_;                      // of (4), then its unknowns, one column a parameter
  Eigen::RowVectorXd dx_, dx_dot_;  // of a law
};

}  // namespace flexarm::sensitivity
