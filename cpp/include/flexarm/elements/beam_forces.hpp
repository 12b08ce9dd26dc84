/// @file
/// Internal and inertia forces of beams, (1) to (4) of beam.hpp, on any kind of numbers: of one, of two side
/// by side (beam_pair.hpp), of the same beam in many arms.
#pragma once

#include "flexarm/elements/uncoupled.hpp"
#include "flexarm/geometry/tangent.hpp"

namespace flexarm::elements {

template <int D, class Real>
struct BeamForces {
  static constexpr int n = geometry::freedoms<D>;
  using Frame = geometry::FrameIn<D, Real>;
  using TwistD = geometry::Twist<D, Real>;
  using Ends = Eigen::Matrix<Real, 2 * n, 1>;

  using Mass = Eigen::Matrix<Real, 2 * n, 2 * n>;

  TwistD K, rest;  ///< stiffness, d₀ + b + η b'
  Real eta;        ///< η
  bool damped;     ///< whether any η is not zero

  /// What frames, velocities u and accelerations u' of both ends ask for there.
  [[gnu::always_inline]] Ends at(const Frame& H1, const Frame& H2, const Ends& u, const Ends& u_dot,
                                 const Mass& M) const {
    const TwistD d = geometry::logarithm<D>(geometry::relative<D>(H1, H2));
    const geometry::InverseTangentIn<D, Real> tangent(d);
    TwistD stress = K.cwiseProduct(d - rest);  // eq. (1)
    if (damped) {
      stress += eta * K.cwiseProduct(tangent.strain_rate(u.template head<n>(), u.template tail<n>()));
    }
    const auto internal = tangent.transpose_times(stress);  // eq. (3)
    const Ends p = Uncoupled<D>::product(M, u);
    Ends f = Uncoupled<D>::product(M, u_dot);  // eq. (4)
    f.template head<n>() -=
        internal.left + geometry::ad_transpose<D, Real>(u.template head<n>(), p.template head<n>());
    f.template tail<n>() +=
        internal.right - geometry::ad_transpose<D, Real>(u.template tail<n>(), p.template tail<n>());
    return f;
  }
};

}  // namespace flexarm::elements
