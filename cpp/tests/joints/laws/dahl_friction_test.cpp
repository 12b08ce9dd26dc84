#include "flexarm/joints/laws/dahl_friction.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "numerics.hpp"

namespace flexarm::tests::dahl_friction_test {

using flexarm::joints::DahlFriction;
using flexarm::joints::LawMemory;
using flexarm::tests::near;

namespace {

constexpr DahlFriction friction{.torque = 3.0, .width = 0.01};

/// Moves to x in n equal steps; returns the energy taken by the trapezoidal rule.
double move(LawMemory& memory, double x, int n) {
  double taken = 0;
  const double dx = (x - memory.x) / n;
  for (int k = 0; k < n; ++k) {
    const double before = friction.torque * memory.z;
    const auto r = friction.respond(memory.x + dx, 0, memory);
    taken += 0.5 * dx * (before + r.force);
    memory = {memory.x + dx, r.z};
  }
  return taken;
}

}  // namespace

TEST_CASE("The force after a path does not depend on the steps it was cut into") {
  for (int n : {2, 7, 100}) {
    LawMemory once, many;
    move(once, 0.013, 1);
    move(many, 0.013, n);
    CHECK(many.z == near(once.z, 1e-13));
    move(once, -0.004, 1);
    move(many, -0.004, n);
    CHECK(many.z == near(once.z, 1e-13));
  }
}

TEST_CASE("Friction starts with stiffness T_c/w and saturates at the Coulomb torque, never beyond") {
  CHECK(friction.respond(0, 0, {}).stiffness == near(friction.torque / friction.width));
  LawMemory memory;
  for (double x : {0.001, 0.01, 0.1, 1.0}) {
    move(memory, x, 1);
    CHECK(friction.torque * memory.z <= friction.torque);
  }
  CHECK(memory.z == near(1));
  move(memory, -1, 1);
  CHECK(memory.z == near(-1));
}

TEST_CASE("A trial leaves the memory as it was") {
  const LawMemory memory{0.3, 0.5};
  friction.respond(0.4, 0, memory);
  CHECK(friction.respond(0.3, 0, memory).force == near(0.5 * friction.torque));
}

TEST_CASE("A cycle of amplitude a takes 4 T_c (a − w), so 4 T_c a for large swings") {
  const double a = 0.2;
  LawMemory memory;
  move(memory, a, 1);
  const double taken = move(memory, -a, 4000) + move(memory, a, 4000);
  const double T = friction.torque, w = friction.width;
  CHECK(taken == near(4 * T * (a - w), 1e-5));  // the trapezoidal rule's error at 1e-4 rad a step
  CHECK(taken < 4 * T * a);
}

TEST_CASE("A cycle much smaller than the width is elastic") {
  LawMemory memory;
  const double a = 1e-3 * friction.width;
  move(memory, a, 100);
  const double taken = move(memory, -a, 100) + move(memory, a, 100);
  CHECK(std::abs(taken) < 1e-2 * 4 * friction.torque * a);
}

}  // namespace flexarm::tests::dahl_friction_test
