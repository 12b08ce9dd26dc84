/// @file
/// A section within a beam, at ξ in [0, 1] between its nodes 1 and 2. With d the logarithm of (1) of beam.hpp
/// and N the beam's shape functions,
///
///     H = H₁ exp(c),  c = ξ d₀ + N (d − d₀)                                                          (1)
///     v = Ad(exp(−c)) v₁ + T_r(c) N (T_r⁻¹(d) v₂ − T_l⁻¹(d) v₁)                                      (2)
///
/// on any kind of numbers: of one beam, of the same beam in many arms.
#pragma once

#include "flexarm/geometry/tangent.hpp"

namespace flexarm::elements {

template <int D, class Real = double>
struct BeamSection {
  using Frame = geometry::FrameIn<D, Real>;
  using TwistD = geometry::Twist<D, Real>;

  TwistD whole = TwistD::Zero(), rest = TwistD::Zero();  ///< d₀, ξ d₀
  geometry::TwistMatrix<D, Real> N = geometry::TwistMatrix<D, Real>::Zero();

  /// Equation (1).
  Frame frame(const Frame& H1, const Frame& H2) const {
    return H1 * geometry::exponential<D, Real>(within(between(H1, H2)));
  }

  /// Equation (2): in the section's axes.
  TwistD velocity(const Frame& H1, const Frame& H2, const TwistD& v1, const TwistD& v2) const {
    const TwistD d = between(H1, H2), c = within(d);
    const TwistD c_dot = N * geometry::InverseTangentIn<D, Real>(d).strain_rate(v1, v2);
    return geometry::adjoint<D>(geometry::exponential<D, Real>(-c)) * v1 +
           geometry::right_tangent<D, Real>(c) * c_dot;
  }

 private:
  static TwistD between(const Frame& H1, const Frame& H2) {
    return geometry::logarithm<D>(geometry::relative<D>(H1, H2));
  }
  TwistD within(const TwistD& d) const { return rest + N * (d - whole); }
};

}  // namespace flexarm::elements
