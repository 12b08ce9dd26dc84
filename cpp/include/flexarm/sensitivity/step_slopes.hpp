/// @file
/// The step of sensitivity.hpp for all parameters at once, split into what state 0 brings along and what ξ₁
/// adds, and the tangent of its linear problem for ξ₁:
///
///     a* = −(T_l⁻¹ ξ₀ + h dv₀)/(β h²) − (½ − β)/β da₀                                                (1)
///     v* = dv₀ + h [(1 − γ) da₀ + γ a*],   v̇* = (a* + α dv̇₀)/(1 + α)                                 (2)
///     da₁ = a* + T_r⁻¹ ξ₁/(β h²),   dv₁ = v* + γ/(β h) T_r⁻¹ ξ₁,   dv̇₁ = v̇* + T_r⁻¹ ξ₁/(β h² (1 + α))  (3)
///     S = K + [γ/(β h) C + M/(β h² (1 + α))] T_r⁻¹                                                    (4)
///
/// C v* + M v̇* goes to the right side of the linear problem while the rows of a node are at hand.
#pragma once

#include <vector>

#include "flexarm/assembly/tangent_parts.hpp"
#include "flexarm/integrators/hht.hpp"
#include "flexarm/simulation/variation.hpp"

namespace flexarm::sensitivity {

using Eigen::VectorXd;
using simulation::Slopes;
using simulation::StateDerivative;

template <int D>
class StepSlopesIn {
 public:
  StepSlopesIn(const assembly::SystemIn<D>& system, const integrators::HhtCoefficients& coefficients);

  /// Tangent operators of a step of size h with this argument of exp.
  void prepare(const VectorXd& exponent, double h);

  /// Equations (1), (2); rhs −= C v* + M v̇*.
  void carry(const StateDerivative& before, const assembly::TangentPartsIn<D>& parts, Slopes& rhs);

  /// Equation (4); the first tangent that comes takes the pattern of the parts.
  void combine(const assembly::TangentPartsIn<D>& parts, Eigen::SparseMatrix<double>& tangent) const;

  /// Equation (3), with ξ₁ in the first rows of `solution`.
  void update(const Slopes& solution, StateDerivative& now) const;

 private:
  const assembly::SystemIn<D>& system_;
  integrators::HhtCoefficients coefficients_;
  double h_ = 0;
  std::vector<geometry::TwistMatrix<D>> left_, right_;  // T_l⁻¹, T_r⁻¹ of each node
  Slopes a_, v_, v_dot_;                                // a*, v*, v̇*
};

}  // namespace flexarm::sensitivity
