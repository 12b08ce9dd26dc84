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

using geometry::Matrix3d;
using geometry::Matrix6d;
using geometry::Twist;
using geometry::TwistMatrix;
using geometry::Vector3d;

template <int D>
class RigidBodyIn {
 public:
  explicit RigidBodyIn(int node, const TwistMatrix<D>& mass = TwistMatrix<D>::Zero())
      : node_(node), M_(mass) {}

  /// Adds a body with its centre at `com` and `inertia` about the centre, both in the node's axes. Equation
  /// (1).
  void add(double mass, const Vector3d& com, const Matrix3d& inertia)
    requires(D == 3);

  int node() const { return node_; }
  const TwistMatrix<D>& mass() const { return M_; }

  Twist<D> inertia_forces(const Twist<D>& v, const Twist<D>& v_dot) const {
    return inertia_forces<double>(M_, v, v_dot);
  }
  /// The same of any kind of numbers. Equation (1).
  template <class Real>
  static Twist<D, Real> inertia_forces(const TwistMatrix<D, Real>& M, const Twist<D, Real>& v,
                                       const Twist<D, Real>& v_dot) {
    return M * v_dot - geometry::ad_transpose<D, Real>(v, M * v);
  }

  /// ∂(inertia forces)/∂v.
  TwistMatrix<D> gyroscopic_matrix(const Twist<D>& v) const {
    return -geometry::ad<D>(v).transpose() * M_ - geometry::ad_transpose_by_twist<D>(M_ * v);
  }

  bool operator==(const RigidBodyIn&) const = default;

 private:
  int node_;
  TwistMatrix<D> M_;
};

using RigidBody = RigidBodyIn<3>;

}  // namespace flexarm::elements
