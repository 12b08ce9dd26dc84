/// @file
/// What parameters do to the joint laws: derivatives of their forces Q and of their memories z,
///
///     dQ/dp = ∂Q/∂x dx + ∂Q/∂x' dx' + ∂Q/∂y dy + ∂Q/∂y' dy' + ∂Q/∂x₀ dx₀ + ∂Q/∂z₀ dz₀ + ∂Q/∂p        (1)
///
/// and alike for z. The laws give their partial derivatives themselves (joints/law_response.hpp); ∂/∂p is the
/// difference of the two laws of a variation, and zero where they are equal.
#pragma once

#include <vector>

#include "flexarm/simulation/variation.hpp"

namespace flexarm::sensitivity {

using simulation::Slopes;
using simulation::StateDerivative;
using simulation::VariationIn;

template <int D>
class LawSlopesIn {
 public:
  LawSlopesIn(const assembly::SystemIn<D>& system, const std::vector<VariationIn<D>>& variations);

  /// Asks all laws at a state, with the memories that it holds. `friction` leaves out laws without a part in
  /// statics.
  void evaluate(const assembly::StateIn<D>& state, bool friction);

  const joints::LawResponse& response(std::size_t law) const { return responses_[law]; }

  /// Equation (1) for the force at fixed x and x': dx₀ and dz₀ are those of `derivative`.
  auto force_of_the_past(std::size_t law, const StateDerivative& derivative) const {
    const auto k = static_cast<Eigen::Index>(law);
    const joints::LawResponse& at = responses_[law];
    return force_.row(k) + at.force_by_x0 * derivative.law_x.row(k) +
           at.force_by_z0 * derivative.law_z.row(k);
  }

  /// Equation (1) for z; dx₀ and dz₀ are those of `before`, dx and dx' of the law's deflection are given.
  template <class Dx, class DxDot>
  auto memory(std::size_t law, const StateDerivative& before, const Dx& dx, const DxDot& dx_dot) const {
    const auto k = static_cast<Eigen::Index>(law);
    const joints::LawResponse& at = responses_[law];
    return z_.row(k) + at.z_by_x * dx + at.z_by_rate * dx_dot + at.z_by_x0 * before.law_x.row(k) +
           at.z_by_z0 * before.law_z.row(k);
  }

 private:
  struct Varied {
    Eigen::Index law, parameter;
    joints::JointLaw plus, minus;
    double spread;
  };

  const assembly::SystemIn<D>& system_;
  std::vector<Varied> varied_;
  std::vector<joints::LawResponse> responses_;
  Slopes force_, z_;  // ∂Q/∂p, ∂z/∂p
};

}  // namespace flexarm::sensitivity
