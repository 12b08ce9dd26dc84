#include "flexarm/elements/rigid_body.hpp"

namespace flexarm::elements {

template <int D>
void RigidBodyIn<D>::add(double mass, const Vector3d& com, const Matrix3d& inertia)
  requires(D == 3)
{
  const Matrix3d c = geometry::skew(com);
  Matrix6d M;
  M << mass * Matrix3d::Identity(), -mass * c, mass * c, inertia - mass * c * c;  // eq. (1)
  M_ += M;
}

template class RigidBodyIn<2>;
template class RigidBodyIn<3>;

}  // namespace flexarm::elements
