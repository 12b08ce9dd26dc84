/// @file
/// Sensitivities of recorded motions of points.
///
/// A point's frame H and its twist v follow from those of its node, or of both ends of its element, by one
/// and the same matrix, v = A v_e. With the twist ξ = A ξ_e by which H moves with a parameter, and the strain
/// d of the element,
///
///     x = H 0,  ẋ = R v_x,    dx/dp = R ξ_x,   dẋ/dp = R (dv_x + ξ_ω × v_x)                          (1)
///     dv = A dv_e + ∂(A v_e)/∂d dd,   dd = T_r⁻¹(d) ξ₂ − T_l⁻¹(d) ξ₁                                 (2)
///     dq/dp = ½ q ∘ ξ_ω                                            for the unit quaternion q of R    (3)
///
/// the same A for all parameters; ∂(A v_e)/∂d by central differences, steps of 1e-5 of the element's length
/// or rad. A parameter that moves the point on its link, or bends the element's shape functions, adds the
/// difference of its two models (variation.hpp) at the state.
#pragma once

#include <vector>

#include "flexarm/simulation/recorder.hpp"
#include "flexarm/simulation/variation.hpp"

namespace flexarm::sensitivity {

using assembly::StateIn;
using assembly::SystemIn;
using simulation::InSpace;
using simulation::Slopes;
using simulation::StateDerivative;
using simulation::Transient;
using simulation::TransientOptions;
using simulation::VariationIn;

/// A variation with the places of both its models in space.
template <int D>
struct VariedInSpace {
  VariationIn<D> variation;
  InSpace<D> plus, minus;
};

template <int D>
class PointSlopesIn {
 public:
  PointSlopesIn(const SystemIn<D>& system, const InSpace<D>& space,
                const std::vector<VariedInSpace<D>>& varied);

  /// Writes column k of `out`, whose rows are those of a Recorder, one for each parameter.
  void record(Eigen::Index k, const TransientOptions& options, const StateIn<D>& state,
              const StateDerivative& derivative, Transient& out);

 private:
  static constexpr int n = geometry::freedoms<D>;
  struct Moving {
    int point;
    Eigen::Index column;
    const VariedInSpace<D>* varied;
  };

  bool moves(int point, const VariedInSpace<D>& varied) const;
  void follow(int point, const StateIn<D>& state, const StateDerivative& derivative);
  void add(const Moving& moving, Eigen::Index k, const TransientOptions& options, const StateIn<D>& state,
           Transient& out) const;

  const SystemIn<D>& system_;
  const InSpace<D> space_;
  const std::vector<VariedInSpace<D>>& varied_;
  std::vector<Moving> moving_;
  Slopes xi_, dv_, dd_, du_;  // of one point: (1), (2)
};

}  // namespace flexarm::sensitivity
