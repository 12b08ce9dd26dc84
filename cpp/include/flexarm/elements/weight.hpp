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

struct Weight {
  double mass = 0;                                         ///< m [kg]
  geometry::Vector3d moment = geometry::Vector3d::Zero();  ///< s [kg m]

  geometry::Vector6d force(const geometry::Matrix3d& R, const geometry::Vector3d& gravity) const {
    const geometry::Vector3d gamma = R.transpose() * gravity;
    geometry::Vector6d f;
    f << mass * gamma, moment.cross(gamma);
    return f;
  }

  double potential(const geometry::Frame& H, const geometry::Vector3d& gravity) const {
    return -gravity.dot(mass * H.x + H.R * moment);  // eq. (1)
  }

  /// −∂force/∂(increment of the node).
  geometry::Matrix6d stiffness(const geometry::Matrix3d& R, const geometry::Vector3d& gravity) const {
    const geometry::Matrix3d gamma = geometry::skew(R.transpose() * gravity);
    geometry::Matrix6d K = geometry::Matrix6d::Zero();
    K.topRightCorner<3, 3>() = -mass * gamma;
    K.bottomRightCorner<3, 3>() = -geometry::skew(moment) * gamma;
    return K;
  }
};

}  // namespace flexarm::elements
