#include "flexarm/joints/laws/reducer_spring.hpp"

#include <doctest/doctest.h>

#include "numerics.hpp"

namespace flexarm::tests::reducer_spring_test {

using flexarm::joints::Flank;
using flexarm::joints::ReducerSpring;
using flexarm::tests::near;

namespace {

constexpr ReducerSpring loose{.stiffness = 1e5,
                              .damping = 200,
                              .cubic_stiffness = 4e9,
                              .gap = 4e-4,
                              .fade_width = 1e-5,
                              .loose_stiffness = 1e-4,
                              .loose_damping = 1e-2};

}  // namespace

TEST_CASE("Beyond the gap the spring is that of the deflection less half the gap") {
  for (double e : {1e-5, 3e-4}) {
    const double torque = 1e5 * e + 4e9 * e * e * e;
    const double shift = 1e-4 * 1e5 * 2e-4;  // ρ k b/2, what the gap leaves
    CHECK(loose.respond(2e-4 + e, 0, {}).force == near(torque + shift));
    CHECK(loose.respond(-2e-4 - e, 0, {}).force == near(-torque - shift));
    CHECK(loose.respond(2e-4 + e, 0.01, {}).force == near(torque + shift + 2));
  }
}

TEST_CASE("Inside the gap next to nothing acts: the stated parts of stiffness and damping") {
  CHECK(loose.respond(1e-4, 0, {}).force == near(1e-4 * 1e5 * 1e-4));
  CHECK(loose.respond(1e-4, 0.01, {}).loss == near(1e-2 * 200 * 0.01));
  CHECK(loose.respond(0, 0.01, {}).damping == near(2));
}

TEST_CASE("Nothing jumps where the teeth meet, and no more than the fading's slope where it ends") {
  for (double edge : {2e-4, -2e-4, 1.9e-4, -1.9e-4}) {
    for (double rate : {-0.1, 0.1}) {
      const auto below = loose.respond(edge - 1e-12, rate, {}), above = loose.respond(edge + 1e-12, rate, {});
      CHECK(std::abs(above.force - below.force) < 1e-6);
      CHECK(std::abs(above.damping - below.damping) < 1e-6);
      CHECK(std::abs(above.energy - below.energy) < 1e-12);
    }
  }
}

TEST_CASE("A gap of zero is none, whatever is left inside gaps") {
  ReducerSpring tight = loose;
  tight.gap = 0;
  for (double x : {-3e-4, 0.0, 2e-5}) {
    const auto r = tight.respond(x, 0.02, {});
    CHECK(r.force == near(1e5 * x + 4e9 * x * x * x + 4));
    CHECK(r.damping == 200);
  }
}

TEST_CASE("A gap narrower than the fading keeps its damping: the law tends to the one without a gap") {
  ReducerSpring narrow = loose;
  narrow.gap = 1e-7;
  CHECK(narrow.respond(0, 0.01, {}).damping == near(200, 1e-3));
}

TEST_CASE("A flank that statics holds is touched from either side, and agrees with the law where it pushes") {
  const double x = 2.5e-4;
  CHECK(loose.respond(x, 0, {.flank = Flank::positive}).force == near(loose.respond(x, 0, {}).force));
  CHECK(loose.respond(-x, 0, {.flank = Flank::negative}).force == near(loose.respond(-x, 0, {}).force));
  CHECK(loose.respond(1e-4, 0, {.flank = Flank::positive}).stiffness > 1e5);
  CHECK(loose.respond(1e-4, 0, {.flank = Flank::closed}).force == near(1e5 * 1e-4 + 4e9 * 1e-12));
}

}  // namespace flexarm::tests::reducer_spring_test
