/// @file
/// Equations (1) to (3) of sensitivity.hpp for all parameters at once, split into what state 0 brings along
/// and what ξ₁ adds:
///
///     a* = −(T_l⁻¹ ξ₀ + h dv₀)/(β h²) − (½ − β)/β da₀                                                (1)
///     v* = dv₀ + h [(1 − γ) da₀ + γ a*],   v̇* = (a* + α dv̇₀)/(1 + α)                                 (2)
///     da₁ = a* + T_r⁻¹ ξ₁/(β h²),   dv₁ = v* + γ/(β h) T_r⁻¹ ξ₁,   dv̇₁ = v̇* + T_r⁻¹ ξ₁/(β h² (1 + α))  (3)
///
/// C v* + M v̇* goes to the right side of its (4) while the rows of a node are at hand.
#pragma once

#include <vector>

#include "flexarm/assembly/tangent_parts.hpp"
#include "flexarm/simulation/variation.hpp"
#include "flexarm/solvers/hht.hpp"

namespace flexarm::simulation {

template <int D>
class StepSlopesIn {
 public:
  StepSlopesIn(const assembly::SystemIn<D>& system, const solvers::HhtCoefficients& coefficients);

  /// Tangent operators of a step of size h with this argument of exp.
  void prepare(const VectorXd& exponent, double h);
  const geometry::TwistMatrix<D>& right_inverse(int node) const { return right_[node]; }  ///< T_r⁻¹

  /// Equations (1), (2); rhs −= C v* + M v̇*.
  void carry(const StateDerivative& before, const assembly::TangentPartsIn<D>& parts, Slopes& rhs);

  /// Equation (3), with ξ₁ in the first rows of `solution`.
  void update(const Slopes& solution, StateDerivative& now) const;

 private:
  const assembly::SystemIn<D>& system_;
  solvers::HhtCoefficients coefficients_;
  double h_ = 0;
  std::vector<geometry::TwistMatrix<D>> left_, right_;  // T_l⁻¹, T_r⁻¹ of each node
  Slopes a_, v_, v_dot_;                                // a*, v*, v̇*
};

}  // namespace flexarm::simulation
