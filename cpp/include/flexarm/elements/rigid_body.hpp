/// @file
/// Inertia of a rigid body that moves with a node: rigid links, payloads, motors.
///
/// With mass m, centre of mass c in the node's axes and inertia J about the centre,
///
///     M = [m I   −m c~; m c~   J − m c~c~],    inertia force  M v' − ad(v)ᵀ M v                (1)
///
/// about the node, in the node's axes; bodies at one node add up. Gravity acts on mass and first moment.
#pragma once

#include "flexarm/geometry/se3.hpp"

namespace flexarm::elements {

using geometry::Frame;
using geometry::Matrix3d;
using geometry::Matrix6d;
using geometry::Vector3d;
using geometry::Vector6d;

class RigidBody {
 public:
  explicit RigidBody(int node) : node_(node) { M_.setZero(); }

  /// Adds a body with its centre at `com` and `inertia` about the centre, both in the node's axes. Equation
  /// (1).
  void add(double mass, const Vector3d& com, const Matrix3d& inertia);

  int node() const { return node_; }
  const Matrix6d& mass() const { return M_; }

  Vector6d inertia_forces(const Vector6d& v, const Vector6d& v_dot) const {
    return M_ * v_dot - geometry::ad_transpose(v, M_ * v);  // eq. (1)
  }

  /// ∂(inertia forces)/∂v.
  Matrix6d gyroscopic_matrix(const Vector6d& v) const {
    return -geometry::ad(v).transpose() * M_ - geometry::ad_transpose_by_twist(M_ * v);
  }

 private:
  int node_;
  Matrix6d M_;
};

}  // namespace flexarm::elements
