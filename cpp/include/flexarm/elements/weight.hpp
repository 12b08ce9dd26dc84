/// @file
/// Gravity on a node: the load that derives from the potential
///
///     V = −g · (m x + R s)                                                                          (1)
///
/// with the mass m and the first moment s (node axes) that rest on the node. Its force in the node's axes is
/// (m γ, s × γ) with γ = Rᵀ g. A beam element gives each end half its mass and ±ρA L²/12 along its axis, its
/// consistent load; being the gradient of (1), the load conserves energy exactly.
#pragma once

#include "flexarm/geometry/se3.hpp"

namespace flexarm::elements {

template <int D, class Real = double>
struct WeightIn {
  using Point = geometry::Point<D, Real>;
  using Rotation = geometry::Rotation<D, Real>;

  Real mass = 0;                 ///< m [kg]
  Point moment = Point::Zero();  ///< s [kg m]

  bool operator==(const WeightIn&) const = default;

  geometry::Twist<D, Real> force(const Rotation& R, const Point& gravity) const {
    const Point gamma = R.transpose() * gravity;
    geometry::Twist<D, Real> f;
    f.template head<D>() = mass * gamma;
    f.template tail<geometry::turns<D>>() = geometry::moment_of<D, Real>(moment, gamma);
    return f;
  }

  double potential(const geometry::FrameIn<D>& H, const Point& gravity) const {
    return -gravity.dot(mass * H.x + H.R * moment);  // eq. (1)
  }

  /// −∂force/∂(increment of the node).
  geometry::TwistMatrix<D> stiffness(const Rotation& R, const Point& gravity) const {
    const auto gamma = geometry::lever_matrix<D>(R.transpose() * gravity);  // dγ = γ × δ
    geometry::TwistMatrix<D> K = geometry::TwistMatrix<D>::Zero();
    K.template topRightCorner<D, geometry::turns<D>>() = -mass * gamma;
    K.template bottomRightCorner<geometry::turns<D>, geometry::turns<D>>() =
        geometry::lever_matrix<D>(moment).transpose() * gamma;  // s × is −(s~)ᵀ
    return K;
  }
};

using Weight = WeightIn<3>;

}  // namespace flexarm::elements
