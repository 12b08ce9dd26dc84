#include "flexarm/elements/rigid_body.hpp"

namespace flexarm::elements {

void RigidBody::add(double mass, const Vector3d& com, const Matrix3d& inertia) {
  const Matrix3d c = geometry::skew(com);
  Matrix6d M;
  M << mass * Matrix3d::Identity(), -mass * c, mass * c, inertia - mass * c * c;  // eq. (1)
  M_ += M;
}

}  // namespace flexarm::elements
