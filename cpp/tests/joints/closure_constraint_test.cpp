#include "flexarm/joints/closure_constraint.hpp"

#include <doctest/doctest.h>

#include "flexarm/errors.hpp"
#include "numerics.hpp"

namespace flexarm::tests::closure_constraint_test {

using namespace flexarm::geometry;
using flexarm::joints::ClosureConstraint;
using flexarm::joints::ClosureType;
using flexarm::joints::Conditions;

namespace {

const ClosureType all_types[] = {ClosureType::revolute,     ClosureType::spherical, ClosureType::universal,
                                 ClosureType::cylindrical,  ClosureType::prismatic, ClosureType::fixed,
                                 ClosureType::point_on_line};

/// A closure between two bodies that stand anywhere.
struct Open {
  ClosureConstraint closure;
  Frame X_a, X_b, H_a, H_b;
  Vector3d axis, second;
};

Open open(ClosureType type, unsigned seed) {
  Random random(seed);
  const Frame X_a = exp6(random.twist(1, 1)), X_b = exp6(random.twist(1, 1));
  const Vector3d axis = 3 * random.unit(), second = 2 * random.unit();  // any length
  return {ClosureConstraint(type, 0, X_a, 1, X_b, axis, second, 1.7),
          X_a,
          X_b,
          exp6(random.twist(2, 2)),
          exp6(random.twist(2, 2)),
          axis.normalized(),
          second};
}

VectorXd gap(const Open& c, const VectorXd& h) {
  return c.closure.residual(c.H_a * exp6(Vector6d(h.head<6>())), c.H_b * exp6(Vector6d(h.tail<6>())));
}

MatrixXd jacobian(const Open& c, const VectorXd& h) {
  const auto J = c.closure.jacobian(c.H_a * exp6(Vector6d(h.head<6>())), c.H_b * exp6(Vector6d(h.tail<6>())));
  MatrixXd both(c.closure.size(), 12);
  both << J.a, J.b;
  return both;
}

}  // namespace

TEST_CASE("The Jacobian of every closure is the derivative of its conditions, wherever the bodies stand") {
  unsigned seed = 1;
  for (const ClosureType type : all_types) {
    const Open c = open(type, seed++);
    CAPTURE(static_cast<int>(type));
    const MatrixXd expected = differences([&](const VectorXd& h) { return gap(c, h); }, 12);
    CHECK(error(jacobian(c, VectorXd::Zero(12)), expected) < 1e-10);
  }
}

TEST_CASE("The geometric stiffness of every closure is the derivative of its forces") {
  unsigned seed = 11;
  for (const ClosureType type : all_types) {
    const Open c = open(type, seed++);
    CAPTURE(static_cast<int>(type));
    const Conditions lambda = Random(seed).vector(c.closure.size(), 4);
    const auto forces = [&](const VectorXd& h) -> VectorXd { return jacobian(c, h).transpose() * lambda; };
    const auto K = c.closure.geometric_stiffness(c.H_a, c.H_b, lambda);
    MatrixXd found(12, 12);
    found << K.a_a, K.a_b, K.b_a, K.b_b;
    CHECK(error(found, differences(forces, 12)) < 1e-9);
  }
}

TEST_CASE("Conditions accelerate by J v' and by what J v changes by at constant body velocities") {
  unsigned seed = 21;
  for (const ClosureType type : all_types) {
    const Open c = open(type, seed++);
    CAPTURE(static_cast<int>(type));
    const VectorXd v = Random(seed).vector(12);
    const auto rate = [&](const VectorXd& t) -> VectorXd { return jacobian(c, t[0] * v) * v; };
    const VectorXd v_dot = Random(seed + 40).vector(12);
    const Conditions found =
        c.closure.acceleration(c.H_a, c.H_b, {v.head<6>(), v.tail<6>()}, {v_dot.head<6>(), v_dot.tail<6>()});
    CHECK(error(found, differences(rate, 1) + jacobian(c, VectorXd::Zero(12)) * v_dot) < 1e-9);
  }
}

TEST_CASE("Forces and conditions found at once are those of the Jacobian and of the gap") {
  unsigned seed = 41;
  for (const ClosureType type : all_types) {
    const Open c = open(type, seed++);
    CAPTURE(static_cast<int>(type));
    const Conditions lambda = Random(seed).vector(c.closure.size(), 4);
    const auto now = c.closure.respond(c.H_a, c.H_b, lambda);
    VectorXd forces(12);
    forces << now.a, now.b;
    CHECK(error(forces, jacobian(c, VectorXd::Zero(12)).transpose() * lambda) < 1e-12);
    CHECK(error(now.residual, gap(c, VectorXd::Zero(12))) < 1e-13);
  }
}

TEST_CASE("A closure within a plane has the conditions of space that its motion could violate") {
  struct Case {
    ClosureType type;
    double lean;  // of the axis from the normal of the plane [rad]
    int size;
    double turn, slide;  // of B in A, about the normal and along the axis
  };
  const double flat = std::acos(0.0);
  const Case cases[] = {{ClosureType::revolute, 0, 2, 0.7, 0},
                        {ClosureType::revolute, flat, 3, 0, 0},
                        {ClosureType::spherical, 0.3, 2, 0.7, 0},
                        {ClosureType::universal, 0, 2, 0.7, 0},
                        {ClosureType::cylindrical, 0, 2, 0.7, 0},
                        {ClosureType::cylindrical, flat, 2, 0, 0.4},
                        {ClosureType::prismatic, 0, 3, 0, 0},
                        {ClosureType::prismatic, flat, 2, 0, 0.4},
                        {ClosureType::fixed, 0.3, 3, 0, 0},
                        {ClosureType::point_on_line, 0, 2, 0.7, 0},
                        {ClosureType::point_on_line, flat, 1, 0.7, 0.4}};
  Random random(51);
  for (const Case& c : cases) {
    CAPTURE(static_cast<int>(c.type));
    CAPTURE(c.lean);
    const Vector3d normal = random.unit();
    const auto turned = [&](double angle) { return Frame::rotation(exp3(angle * normal)); };
    const PlaneAxes base = PlaneAxes::with_normal(normal, random.unit());
    const auto anywhere = [&] {  // with its origin in the plane
      return Frame{exp3(random.vector(3)), base.embed(random.vector(2))};
    };
    const Frame H_a = anywhere(), H_b = anywhere(), A = anywhere();
    const Vector3d axis = exp3(c.lean * base.E.col(0)) * normal;
    const Frame B =
        Frame::translation(c.slide * axis) * Frame::translation(A.x) * turned(c.turn) * Frame::rotation(A.R);
    const ClosureConstraint closure(c.type, 0, H_a.inverse() * A, 1, H_b.inverse() * B,
                                    A.R.transpose() * axis, A.R.transpose() * base.E.col(1), 1.7);
    const PlaneAxes at_a = base.seen_from(H_a.R), at_b = base.seen_from(H_b.R);
    const auto found = closure.planar_part(at_a, at_b);
    REQUIRE(found);
    CHECK(found->closure.size() == c.size);
    CHECK((found->combinations.transpose() * found->combinations).isIdentity(1e-12));
    const auto flat_a = in_plane(H_a, base, at_a), flat_b = in_plane(H_b, base, at_b);
    const auto J = closure.jacobian(H_a, H_b);
    const auto J_flat = found->closure.jacobian(flat_a, flat_b);
    CHECK(found->closure.residual(flat_a, flat_b).norm() < 1e-13);
    CHECK(error(J_flat.a, found->combinations.transpose() * J.a * at_a.within()) < 1e-12);
    CHECK(error(J_flat.b, found->combinations.transpose() * J.b * at_b.within()) < 1e-12);
    const MatrixXd P = found->combinations * found->combinations.transpose();  // all others hold anyway
    CHECK(largest(J.a * at_a.within() - P * J.a * at_a.within()) < 1e-12);
    CHECK(largest(J.b * at_b.within() - P * J.b * at_b.within()) < 1e-12);
  }
}

TEST_CASE("A closure that ties what lies across a plane to what lies within has no part within") {
  const PlaneAxes axes = PlaneAxes::with_normal(Vector3d::UnitZ(), Vector3d::UnitX());
  const Vector3d leaning(0.6, 0, 0.8);
  for (const ClosureType type : {ClosureType::revolute, ClosureType::universal, ClosureType::cylindrical,
                                 ClosureType::point_on_line}) {
    CAPTURE(static_cast<int>(type));
    const ClosureConstraint closure(type, 0, {}, 1, {}, leaning, Vector3d(0.8, 0.1, -0.6), 1);
    CHECK(!closure.planar_part(axes, axes));
  }
}

TEST_CASE("What a closure leaves free does not violate it, and its number of conditions is known") {
  const auto conditions = [](ClosureType type) { return open(type, 1).closure.size(); };
  CHECK(conditions(ClosureType::revolute) == 5);
  CHECK(conditions(ClosureType::spherical) == 3);
  CHECK(conditions(ClosureType::universal) == 4);
  CHECK(conditions(ClosureType::cylindrical) == 4);
  CHECK(conditions(ClosureType::prismatic) == 5);
  CHECK(conditions(ClosureType::fixed) == 6);
  CHECK(conditions(ClosureType::point_on_line) == 2);
  const auto met = [](ClosureType type, const std::function<Frame(const Vector3d& axis)>& between) {
    const Open c = open(type, 5);
    const Frame H_b = c.H_a * c.X_a * between(c.axis) * c.X_b.inverse();
    return c.closure.residual(c.H_a, H_b).lpNorm<Eigen::Infinity>() < 1e-14 &&
           c.closure.axes_agree(c.H_a, H_b);
  };
  const auto turned = [](const Vector3d& u) { return Frame::rotation(exp3(2.1 * u)); };
  const auto shifted = [](const Vector3d& u) { return Frame::translation(0.7 * u); };
  const auto both = [&](const Vector3d& u) { return shifted(u) * turned(u); };
  const auto any_turn = [](const Vector3d&) { return Frame::rotation(exp3({0.3, -1.2, 0.9})); };
  CHECK(met(ClosureType::revolute, turned));
  CHECK(!met(ClosureType::revolute, shifted));
  CHECK(!met(ClosureType::revolute, any_turn));
  CHECK(met(ClosureType::spherical, any_turn));
  CHECK(!met(ClosureType::spherical, shifted));
  CHECK(met(ClosureType::cylindrical, both));
  CHECK(!met(ClosureType::cylindrical, any_turn));
  CHECK(met(ClosureType::prismatic, shifted));
  CHECK(!met(ClosureType::prismatic, turned));
  CHECK(met(ClosureType::fixed, [](const Vector3d&) { return Frame{}; }));
  CHECK(!met(ClosureType::fixed, turned));
  CHECK(met(ClosureType::point_on_line, [&](const Vector3d& u) { return shifted(u) * any_turn(u); }));
  const auto over = [](const Vector3d& u) {
    return Frame::rotation(exp3(std::acos(-1.0) * u.unitOrthogonal()));
  };
  CHECK(!met(ClosureType::revolute, over));
}

TEST_CASE("The wrench on b and its reaction on a do the work of the multipliers") {
  for (const ClosureType type : all_types) {
    const Open c = open(type, 31);
    const Conditions lambda = Random(32).vector(c.closure.size(), 4);
    const Vector6d v = Random(33).twist(1, 1);  // of node b
    const Frame B = c.H_b * c.X_b;
    const Vector6d at_B = adjoint_product<3>(c.X_b.inverse(), v);
    const Vector6d wrench = c.closure.wrench_on_b(c.H_a, c.H_b, lambda);
    const double power =
        wrench.head<3>().dot(B.R * at_B.head<3>()) + wrench.tail<3>().dot(B.R * at_B.tail<3>());
    CHECK(power == near(-lambda.dot(c.closure.jacobian(c.H_a, c.H_b).b * v), 1e-12));
  }
}

TEST_CASE("A closure without a direction is refused") {
  const auto make = [](const Vector3d& axis, const Vector3d& second) {
    return ClosureConstraint(ClosureType::universal, 0, Frame{}, 1, Frame{}, axis, second, 1);
  };
  CHECK_THROWS_AS(make(Vector3d::Zero(), Vector3d::UnitX()), flexarm::InvalidParameter);
  CHECK_THROWS_AS(make(Vector3d::UnitX(), Vector3d::UnitX()), flexarm::InvalidParameter);
}

TEST_CASE("The turn of a revolute closure is the angle of B about the axis in A") {
  const Open c = open(ClosureType::revolute, 4);
  for (const double angle : {-3.0, -0.4, 0.1, 1.2, 3.1}) {
    Vector6d about;
    about << 0, 0, 0, angle * c.axis;
    CHECK(c.closure.hinge_angle(c.H_a, c.H_a * c.X_a * exp6(about) * c.X_b.inverse()) == near(angle, 1e-12));
  }
}

}  // namespace flexarm::tests::closure_constraint_test
