/// @file
/// Results are told in space, whether the motion was computed there or in a plane.
#pragma once

#include "flexarm/assembly/planar_system.hpp"

namespace flexarm::simulation {

using geometry::FrameIn;
using geometry::Matrix3d;
using geometry::Point;
using geometry::Turn;
using geometry::Twist;
using geometry::Vector3d;
using geometry::Vector6d;

/// Places, arrows and wrenches of a motion, as they are in space.
template <int D>
class InSpace;

template <>
class InSpace<3> {
 public:
  Vector3d place(int, const Vector3d& x) const { return x; }
  Vector3d arrow(const Vector3d& a) const { return a; }
  Matrix3d orientation(int, const Matrix3d& R) const { return R; }
  Vector3d spin_at_point(int, const Vector3d& omega) const { return omega; }
  Vector6d wrench_at_node(int, const Vector6d& f) const { return f; }
  Vector6d wrench_on_base(std::size_t, const Vector6d& f) const { return f; }
};

template <>
class InSpace<2> {
 public:
  explicit InSpace(const assembly::PlanarSystem& plane) : plane_(plane) {}

  /// Of a point, base axes.
  Vector3d place(int point, const Point<2>& x) const {
    const auto& base = plane_.base_axes();
    return base.embed(x) + plane_.point_distance(point) * base.normal();
  }
  /// Base axes.
  Vector3d arrow(const Point<2>& a) const { return plane_.base_axes().embed(a); }
  /// Link axes at a point to base axes.
  Matrix3d orientation(int point, const geometry::Rotation<2>& R) const {
    return geometry::in_space({R, Point<2>::Zero()}, 0, plane_.base_axes(), plane_.point_axes(point)).R;
  }
  /// Link axes at a point.
  Vector3d spin_at_point(int point, const Turn<2>& omega) const {
    return omega[0] * plane_.point_axes(point).normal();
  }
  /// The node's axes.
  Vector6d wrench_at_node(int node, const Twist<2>& f) const { return plane_.node_axes(node).within() * f; }
  /// Base axes, about the base's origin: a joint beside the plane through it has a lever.
  Vector6d wrench_on_base(std::size_t constraint, const Twist<2>& f) const {
    const auto& base = plane_.base_axes();
    Vector6d wrench = base.within() * f;
    wrench.tail<3>() += plane_.ground_distance(constraint) * base.normal().cross(wrench.head<3>());
    return wrench;
  }

 private:
  const assembly::PlanarSystem& plane_;
};

}  // namespace flexarm::simulation
