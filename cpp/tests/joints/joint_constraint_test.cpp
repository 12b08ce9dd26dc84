#include "flexarm/joints/joint_constraint.hpp"

#include <doctest/doctest.h>

#include "numerics.hpp"

namespace flexarm::tests::joint_constraint_test {

using namespace flexarm::geometry;
using flexarm::joints::JointConstraint;
using flexarm::joints::JointType;

namespace {

const JointType all_types[] = {JointType::revolute, JointType::prismatic, JointType::fixed,
                               JointType::spherical};

/// A joint between two placed bodies, closed exactly.
struct Closed {
  JointConstraint joint;
  Frame H_a, H_b;
  double theta;
};

Closed closed(JointType type, bool on_ground, unsigned seed, double theta = 0.7) {
  Random random(seed);
  const Frame X_a = exp6(random.twist(1, 1)), X_b = exp6(random.twist(1, 1));
  const Vector3d axis = 3 * random.unit();  // any length
  const bool moves = type == JointType::revolute || type == JointType::prismatic;
  JointConstraint joint(type, on_ground ? JointConstraint::ground : 0, X_a, 1, X_b, axis, moves ? 0 : -1);
  const Frame H_a = on_ground ? Frame{} : exp6(random.twist(2, 2));
  Frame between = exp6(theta * joint.twist());
  if (type == JointType::spherical) between = Frame::rotation(exp3(random.vector(3)));
  return {joint, H_a, H_a * X_a * between * X_b.inverse(), theta};
}

VectorXd violation(const Closed& c, const VectorXd& h_a, const VectorXd& h_b, double d_theta) {
  return c.joint.violation(c.H_a * exp6(h_a), c.H_b * exp6(h_b), c.theta + d_theta).head(c.joint.rows());
}

const VectorXd none = VectorXd::Zero(6);

}  // namespace

TEST_CASE("A closed joint is not violated, and its freedom does not violate it") {
  for (JointType type : all_types) {
    for (double theta : {0.0, 0.7, 3.0, 40.0}) {  // several turns
      const Closed c = closed(type, false, 1, theta);
      CAPTURE(static_cast<int>(type));
      CAPTURE(theta);
      CHECK(largest(c.joint.violation(c.H_a, c.H_b, theta)) < 1e-13 * (1 + theta));
    }
  }
}

TEST_CASE("Response in one pass: the forces and the violation, of an open joint too") {
  for (JointType type : all_types) {
    for (bool on_ground : {false, true}) {
      const Closed c = closed(type, on_ground, 6);
      Random random(7);
      Vector6d lambda = random.twist(5, 5);
      lambda.tail(6 - c.joint.rows()).setZero();
      const Frame H_b = c.H_b * exp6(random.twist(0.2, 0.3));
      const auto both = c.joint.respond(c.H_a, H_b, c.theta, lambda);
      const auto f = c.joint.forces(c.H_a, H_b, c.theta, lambda);
      CAPTURE(static_cast<int>(type));
      CHECK(largest(both.violation) > 0.01);
      CHECK(error(both.violation, c.joint.violation(c.H_a, H_b, c.theta)) < 1e-14);
      CHECK(error(both.forces.a, f.a) < 1e-13);
      CHECK(error(both.forces.b, f.b) < 1e-13);
    }
  }
}

TEST_CASE("The twist is a unit turn or slide about the axis") {
  using flexarm::joints::motion_twist;
  const Vector3d axis(0, 3, 4);
  CHECK(error(motion_twist(JointType::revolute, axis), (Vector6d() << 0, 0, 0, 0, 0.6, 0.8).finished()) <
        1e-16);
  CHECK(error(motion_twist(JointType::prismatic, axis), (Vector6d() << 0, 0.6, 0.8, 0, 0, 0).finished()) <
        1e-16);
  CHECK(largest(motion_twist(JointType::fixed, axis)) == 0);
}

TEST_CASE("Jacobians are the derivatives of the constraints where they hold") {
  for (JointType type : all_types) {
    for (bool on_ground : {false, true}) {
      const Closed c = closed(type, on_ground, 2);
      const int m = c.joint.rows();
      const auto J = c.joint.jacobian(c.H_a, c.H_b, c.theta);
      CAPTURE(static_cast<int>(type));
      const auto by_a = [&](const VectorXd& h) { return violation(c, h, none, 0); };
      const auto by_b = [&](const VectorXd& h) { return violation(c, none, h, 0); };
      CHECK(error(J.a.topRows(m), differences(by_a, 6)) < 1e-9);
      CHECK(error(J.b.topRows(m), differences(by_b, 6)) < 1e-9);
      if (c.joint.coordinate() >= 0) {
        const auto by_theta = [&](const VectorXd& t) { return violation(c, none, none, t[0]); };
        CHECK(error(J.theta, differences(by_theta, 1)) < 1e-10);
      }
    }
  }
}

TEST_CASE("Forces of a joint do no work on motions that it permits, and balance between the bodies") {
  for (JointType type : all_types) {
    for (bool on_ground : {false, true}) {
      const Closed c = closed(type, on_ground, 3);
      Random random(4);
      Vector6d lambda = random.twist(5, 5);
      lambda.tail(6 - c.joint.rows()).setZero();
      const auto f = c.joint.forces(c.H_a, c.H_b, c.theta, lambda);
      CAPTURE(static_cast<int>(type));
      // Moved to the origin, the wrenches on both bodies cancel: action and reaction.
      const Vector6d sum =
          adjoint(c.H_a.inverse()).transpose() * f.a + adjoint(c.H_b.inverse()).transpose() * f.b;
      CHECK(largest(sum) < 1e-12);
      const auto J = c.joint.jacobian(c.H_a, c.H_b, c.theta);
      CHECK(error(f.a, J.a.transpose() * lambda) < 1e-13);
      CHECK(error(f.b, J.b.transpose() * lambda) < 1e-13);
    }
  }
}

TEST_CASE("The geometric stiffness is the derivative of the joint's forces") {
  for (JointType type : all_types) {
    const Closed c = closed(type, false, 5);
    Random random(6);
    Vector6d lambda = random.twist(5, 5);
    lambda.tail(6 - c.joint.rows()).setZero();
    const auto K = c.joint.geometric_stiffness(c.H_a, c.H_b, c.theta, lambda);
    CAPTURE(static_cast<int>(type));
    const auto forces = [&](const VectorXd& h_a, const VectorXd& h_b, double t) -> VectorXd {
      const auto f = c.joint.forces(c.H_a * exp6(h_a), c.H_b * exp6(h_b), c.theta + t, lambda);
      VectorXd both(12);
      both << f.a, f.b;
      return both;
    };
    MatrixXd by_a = MatrixXd::Zero(12, 6), by_b = by_a, by_theta = MatrixXd::Zero(12, 1);
    by_a.topRows(6) = K.a_a;
    by_b.topRows(6) = K.a_b;
    by_theta.topRows(6) = K.a_theta;
    const double tolerance = 1e-9 * largest(lambda);
    CHECK(error(by_a, differences([&](const VectorXd& h) { return forces(h, none, 0); }, 6)) < tolerance);
    CHECK(error(by_b, differences([&](const VectorXd& h) { return forces(none, h, 0); }, 6)) < tolerance);
    if (c.joint.coordinate() >= 0) {
      CHECK(error(by_theta, differences([&](const VectorXd& t) { return forces(none, none, t[0]); }, 1)) <
            tolerance);
    }
  }
}

}  // namespace flexarm::tests::joint_constraint_test
