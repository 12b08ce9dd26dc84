/// @file
/// Directions across a joint's axis, turned by the joint: T of (3) in solvers/tangent_changes.hpp, on any
/// kind of numbers.
#pragma once

#include "flexarm/geometry/frame.hpp"

namespace flexarm::solvers {

/// Translations and rotations that turn with a joint: across its axis; all of the plane.
template <int D>
inline constexpr int across_joint = D == 2 ? 3 : 4;

template <int D, class Real = double>
using Turned = Eigen::Matrix<Real, across_joint<D>, across_joint<D>>;

inline geometry::SineCosine<double> sine_cosine(double phi) { return {std::sin(phi), std::cos(phi)}; }

/// T(θ). @param motion ξ. @param slides whether the joint is prismatic
template <int D, class Real = double>
Turned<D, Real> turned(const geometry::As<geometry::Twist<D, Real>>& motion, bool slides, const Real& theta) {
  Turned<D, Real> T;
  if constexpr (D == 2) {
    const geometry::FrameIn<2, Real> H = geometry::exponential<2, Real>(-theta * motion);
    T << H.R(0, 0), H.R(0, 1), H.x[1], H.R(1, 0), H.R(1, 1), -H.x[0], 0, 0,
        1;  // Ad
  } else if (slides) {
    T.setIdentity();
    T(0, 3) = theta;
    T(1, 2) = -theta;
  } else {
    const auto [s, c] = sine_cosine(theta);
    T << c, s, 0, 0, -s, c, 0, 0, 0, 0, c, s, 0, 0, -s, c;
  }
  return T;
}

}  // namespace flexarm::solvers
