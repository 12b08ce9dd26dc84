/// @file
/// A plane of motion, seen from a frame: what of space lies in it and what lies across it.
///
/// With unit axes e₁, e₂ in the plane and its normal n, E = [e₁ e₂ n], twists of the plane are h = P h₂ and
/// those across it h = Q h⊥,
///
///     P = [e₁ e₂ 0; 0 0 n],   Q = [n 0 0; 0 e₁ e₂]                                                   (1)
///
/// A frame H whose normal stays and whose origin keeps its distance z from the plane through the parent's
/// origin is a frame of the plane,
///
///     E_parentᵀ R E = [R₂ 0; 0 1],   E_parentᵀ x = (x₂, z)                                           (2)
#pragma once

#include "flexarm/geometry/se3.hpp"

namespace flexarm::geometry {

struct PlaneAxes {
  Matrix3d E = Matrix3d::Identity();

  /// Axes for the normal `n` whose first is `towards`, freed of what it has along n.
  static PlaneAxes with_normal(const Vector3d& n, const Vector3d& towards);

  Vector3d normal() const { return E.col(2); }
  Eigen::Matrix<double, 6, 3> within() const;  ///< P
  Eigen::Matrix<double, 6, 3> across() const;  ///< Q
  /// The same axes seen from a frame that is turned by R against this one.
  PlaneAxes seen_from(const Matrix3d& R) const { return {R.transpose() * E}; }

  Vector2d part(const Vector3d& a) const { return E.leftCols<2>().transpose() * a; }
  Vector3d embed(const Vector2d& a) const { return E.leftCols<2>() * a; }
};

/// Equation (2) for a frame between `parent` and `own` axes.
FrameIn<2> in_plane(const Frame& H, const PlaneAxes& parent, const PlaneAxes& own);
Frame in_space(const FrameIn<2>& H, double z, const PlaneAxes& parent, const PlaneAxes& own);

/// How far a frame is from (2): the tilt of its normal [rad].
double tilt(const Frame& H, const PlaneAxes& parent, const PlaneAxes& own);

}  // namespace flexarm::geometry
