/// @file
/// Directions that a joint turns, and how it turns them: P, Q and T of (2), (3) in
/// integrators/woodbury_update.hpp, T on any kind of numbers.
#pragma once

#include "flexarm/geometry/frame.hpp"

namespace flexarm::integrators {

/// Directions that turn with a joint: translations and rotations across its axis, or translations of the
/// plane.
template <int D>
inline constexpr int across_joint = D == 2 ? 2 : 4;
/// Entries of the multipliers that they reach.
template <int D>
inline constexpr int rows_across = D == 2 ? 2 : 6;

template <int D, class Real = double>
using Turned = Eigen::Matrix<Real, across_joint<D>, across_joint<D>>;

/// Columns P of multipliers and Q of the parent's twists.
template <int D>
struct DirectionsOf {
  Eigen::Matrix<double, rows_across<D>, across_joint<D>> P;
  Eigen::Matrix<double, geometry::freedoms<D>, across_joint<D>> Q;
};

/// @param motion ξ. @param slides whether the joint is prismatic
template <int D>
DirectionsOf<D> directions_of(const geometry::Twist<D>& motion, bool slides) {
  DirectionsOf<D> of;
  of.P.setZero();
  of.Q.setZero();
  if constexpr (D == 2) {
    if (slides) {  // a turn of the parent moves the joint across the slide
      of.P.col(0) << motion[1], -motion[0];
      of.Q(2, 0) = 1;
    } else {
      of.P.setIdentity();
      of.Q.template topRows<2>().setIdentity();
    }
  } else {
    const geometry::Vector3d axis = slides ? motion.template head<3>() : motion.template tail<3>();
    Eigen::Matrix<double, 3, 2> plane;
    plane.col(0) = axis.unitOrthogonal();
    plane.col(1) = axis.normalized().cross(plane.col(0));
    of.P.template topLeftCorner<3, 2>() = of.P.template bottomRightCorner<3, 2>() = plane;
    of.Q = of.P;
  }
  return of;
}

inline geometry::SineCosine<double> sine_cosine(double phi) { return {std::sin(phi), std::cos(phi)}; }

/// T(θ).
template <int D, class Real = double>
Turned<D, Real> turned(const geometry::As<geometry::Twist<D, Real>>& motion, bool slides, const Real& theta) {
  Turned<D, Real> T;
  if constexpr (D == 2) {
    if (slides) {
      T.setZero();
      T(0, 0) = -theta;
    } else {
      const auto [s, c] = sine_cosine(Real(theta * motion[2]));
      T << c, s, -s, c;
    }
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

}  // namespace flexarm::integrators
