#include "flexarm/joints/laws/lugre_friction.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "flexarm/joints/laws/dahl_friction.hpp"
#include "numerics.hpp"

namespace flexarm::tests::lugre_friction_test {

using namespace flexarm::joints;
using flexarm::tests::near;

namespace {

// Canudas de Wit et al. 1995, table I.
const double s0 = 1e5, s1 = std::sqrt(1e5), s2 = 0.4, coulomb = 1, breakaway = 1.5, stribeck = 1e-3;
const LugreFriction friction{s0, s1, s2, coulomb, breakaway, stribeck};

double slipping(double v) {
  return coulomb + (breakaway - coulomb) * std::exp(-v * v / (stribeck * stribeck));
}

/// Moves at a steady rate for a time in n steps.
LawMemory moved(LawMemory memory, double rate, double time, int n) {
  for (int k = 0; k < n; ++k) {
    const double x = memory.x + rate * time / n;
    memory = {.x = x, .z = friction.respond(x, rate, memory).z};
  }
  return memory;
}

}  // namespace

TEST_CASE("Sliding steadily it is g(v) + σ₂ v against the motion") {
  for (double v : {1e-4, 1e-3, 0.1, -0.02}) {
    const LawMemory memory = moved({}, v, 1e-3 / std::abs(v), 10);
    const double expected = (v < 0 ? -slipping(v) : slipping(v)) + s2 * v;
    CHECK(friction.respond(memory.x + v * 1e-3, v, memory).force == near(expected, 1e-12));
  }
}

TEST_CASE("At a steady rate the state does not depend on the steps the path was cut into") {
  const double v = 2e-3, time = 4e-3;
  CHECK(moved({}, v, time, 1).z == near(moved({}, v, time, 1000).z, 1e-11));
}

TEST_CASE("However large the step, the bristles never hold more than they break away at") {
  for (double dx : {1e-7, 1e-5, 1e-2, 10.0}) {
    for (double v : {0.0, 1e-4, 1.0}) {
      CHECK(std::abs(s0 * friction.respond(dx, v, {.z = 1.4e-5}).z) <= breakaway);
      CHECK(std::abs(s0 * friction.respond(-dx, -v, {.z = 1.4e-5}).z) <= breakaway);
    }
  }
}

TEST_CASE("Without Stribeck's bulge, damping and viscosity it is Dahl's law of width F/σ₀") {
  const LugreFriction plain{s0, 0, 0, coulomb, coulomb, stribeck};
  const DahlFriction dahl{coulomb, coulomb / s0};
  LawMemory bristles, friction_state;
  for (double x : {3e-6, 2e-5, 1e-5, -4e-5}) {
    const auto one = plain.respond(x, 0.01, bristles);
    const auto other = dahl.respond(x, 0.01, friction_state);
    CHECK(one.force == near(other.force));
    bristles = {.x = x, .z = one.z};
    friction_state = {.x = x, .z = other.z};
  }
}

TEST_CASE("Stuck, the bristles are a spring and damper: σ₀ and σ₁ + σ₂") {
  const auto r = friction.respond(0, 0, {});
  CHECK(r.stiffness == near(s0));
  CHECK(r.damping == near(s1 + s2));
}

}  // namespace flexarm::tests::lugre_friction_test
