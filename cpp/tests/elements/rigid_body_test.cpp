#include "flexarm/elements/rigid_body.hpp"

#include <doctest/doctest.h>

#include "numerics.hpp"

namespace flexarm::tests::rigid_body_test {

using flexarm::elements::RigidBody;
using namespace flexarm::geometry;

namespace {

Matrix3d some_inertia(Random& random) {
  const Matrix3d A = Eigen::Map<const Matrix3d>(random.vector(9).data());
  return A * A.transpose() + Matrix3d::Identity();
}

}  // namespace

TEST_CASE("Kinetic energy is that of the centre plus that of the turn about it, whatever the node") {
  Random random(1);
  const double m = 3.2;
  const Vector3d c = random.vector(3);
  const Matrix3d J = some_inertia(random);
  RigidBody body(0);
  body.add(m, c, J);
  for (int n = 0; n < 5; ++n) {
    const Vector6d v = random.twist(2, 2);
    const Vector3d omega = v.tail<3>(), v_centre = v.head<3>() + omega.cross(c);
    const double T = 0.5 * m * v_centre.squaredNorm() + 0.5 * omega.dot(J * omega);
    CHECK(0.5 * v.dot(body.mass() * v) == near(T, 1e-14));
  }
}

TEST_CASE("Inertia forces are Newton's and Euler's of the centre of mass, moved to the node") {
  Random random(2);
  const double m = 1.7;
  const Vector3d c = random.vector(3);
  const Matrix3d J = some_inertia(random);
  RigidBody body(0);
  body.add(m, c, J);
  const Vector6d v = random.twist(2, 2), v_dot = random.twist(2, 2);
  const Vector3d omega = v.tail<3>(), omega_dot = v_dot.tail<3>();
  // Acceleration of the centre in turning axes: x'' = v' + ω × v for the node, and the usual terms for c.
  const Vector3d a =
      v_dot.head<3>() + omega.cross(v.head<3>()) + omega_dot.cross(c) + omega.cross(omega.cross(c));
  Vector6d expected;
  expected << m * a, J * omega_dot + omega.cross(J * omega) + c.cross(m * a);
  CHECK(error(body.inertia_forces(v, v_dot), expected) < 1e-13);
}

TEST_CASE("The gyroscopic matrix is the derivative of the inertia forces") {
  Random random(3);
  RigidBody body(0);
  body.add(2.0, random.vector(3), some_inertia(random));
  body.add(0.7, random.vector(3), some_inertia(random));
  const Vector6d v = random.twist(2, 2), v_dot = random.twist(2, 2);
  const auto f = [&](const VectorXd& d) -> VectorXd { return body.inertia_forces(v + d, v_dot); };
  CHECK(relative_error(body.gyroscopic_matrix(v), differences(f, 6)) < 1e-11);
}

TEST_CASE("Two bodies at one node add up") {
  Random random(4);
  const Vector3d c1 = random.vector(3), c2 = random.vector(3);
  const Matrix3d J1 = some_inertia(random), J2 = some_inertia(random);
  RigidBody one(0), two(0), both(0);
  one.add(2, c1, J1);
  two.add(3, c2, J2);
  both.add(2, c1, J1);
  both.add(3, c2, J2);
  CHECK(error(both.mass(), one.mass() + two.mass()) < 1e-15);
}

}  // namespace flexarm::tests::rigid_body_test
