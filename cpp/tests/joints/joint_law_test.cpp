#include "flexarm/joints/joint_law.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "flexarm/errors.hpp"
#include "numerics.hpp"

namespace flexarm::tests::joint_law_test {

// Designated initialisers name what matters to a test and leave the rest at its default on purpose.
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"

using flexarm::tests::near;
using namespace flexarm::joints;
using flexarm::tests::derivative;

namespace {

// Steep enough beside the spring of 300 N m/rad, with a flat part and held ends.
const MonotoneCubic table({-30, -10, -2, 5, 40}, {-0.08, -0.03, -0.03, 0.02, 0.05});

const MonotoneCubic curve({-0.5, -0.1, 0.3, 0.9}, {-0.02, 0.01, 0.05, 0.03});
const MonotoneCubic soft({-30, 40}, {0.05, -0.03});
const ChangingTable falling({{-0.2, 0.0, 0.4}, {-3, 1, 2}}, {{-0.1, 0.1}, {3, -2}}, -0.01, 0.05);

const std::vector<JointLaw> all_laws = {
    ReducerSpring{300, 4, 2e3},
    ReducerSpring{.stiffness = 300, .damping = 4, .gap = 0.11, .fade_width = 0.02},
    CableTorque{70, 0.3},
    ViscousFriction{0.8},
    DahlFriction{2.5, 0.05},
    LugreFriction{50, 0.9, 0.4, 2.0, 3.0, 0.5},
    TabulatedTorque{Of::angle, MonotoneCubic({-0.2, 0.0, 0.4}, {-3, 1, 2})},
    TabulatedTorque{Of::rate, MonotoneCubic({-0.9, 0.0, 0.9}, {-3, 1, 2})},
    TabulatedFriction{MonotoneCubic({-0.2, 0.0, 0.4}, {-3, 1, 2}), 0.05},
    TabulatedTorque{Of::angle, falling},
    WoundSpring{{300, 4, 2e3}, Of::torque, table},
    WoundSpring{{.stiffness = 300, .damping = 4, .gap = 0.11, .fade_width = 0.02}, Of::torque, table},
    EndCushion{.low = -0.055, .high = 0.2, .stiffness = 400, .length = 0.04, .damping = 3},
    EndCushion{.low = -0.4, .high = 0.1, .stiffness = 400, .length = 0.2, .damping = 3}};

const std::vector<JointLaw> laws_of_two = {
    TabulatedTorque{Of::motor_angle, curve},
    WoundSpring{{300, 4, 2e3}, Of::torque, {table, soft, 0.01, 0.05}},
    WoundSpring{{300, 4, 2e3}, Of::angle, curve},
    WoundSpring{{300, 4, 2e3}, Of::rate, curve},
    OilColumn{1e6, 0.02, 0.01, 1e-3, 0.05, 0.4, 4},
    RadialClearance{{.stiffness = 300, .damping = 4, .gap = 0.2}},
    RadialClearance{{.stiffness = 300, .damping = 4, .gap = 0.36, .fade_width = 0.05}, -1}};
static_assert(std::variant_size_v<JointLaw> == 11, "a new law joins all_laws or laws_of_two");

}  // namespace

TEST_CASE("Stiffness and damping of every law are the derivatives of its force") {
  const LawMemory memory{.x = 0.02, .z = 0.03};
  for (const JointLaw& law : all_laws) {
    for (double x : {-0.07, -0.045, 0.05, 0.3}) {  // beyond, inside and at the edge of the gap
      const double x_dot = 0.4;
      const auto by_x = [&](double y) { return respond(law, y, x_dot, memory).force; };
      const auto by_rate = [&](double y) { return respond(law, x, y, memory).force; };
      const LawResponse r = respond(law, x, x_dot, memory);
      CAPTURE(law.index());
      CAPTURE(x);
      CHECK(r.stiffness == near(derivative(by_x, x, 1e-4), 1e-8));
      CHECK(r.damping == near(derivative(by_rate, x_dot, 1e-3), 1e-8));
    }
  }
}

TEST_CASE("Laws of a second coordinate have its derivatives too, and no more of their own") {
  for (const JointLaw& law : laws_of_two) {
    const double x = 0.07, x_dot = 0.4;
    const LawArgument y{0.15, -0.3};
    const auto force = [&](double dx, double dv, double dy, double dw) {
      return respond(law, x + dx, x_dot + dv, {}, {y.value + dy, y.rate + dw}).force;
    };
    const LawResponse r = respond(law, x, x_dot, {}, y);
    const auto close = [](double found, double expected) { return std::abs(found - expected) < 1e-7; };
    CAPTURE(law.index());
    CHECK(close(r.stiffness, derivative([&](double d) { return force(d, 0, 0, 0); }, 0, 1e-4)));
    CHECK(close(r.damping, derivative([&](double d) { return force(0, d, 0, 0); }, 0, 1e-4)));
    CHECK(close(r.force_by_y, derivative([&](double d) { return force(0, 0, d, 0); }, 0, 1e-4)));
    CHECK(close(r.force_by_y_rate, derivative([&](double d) { return force(0, 0, 0, d); }, 0, 1e-4)));
  }
}

TEST_CASE("A spring that winds up with its torque balances: x = d + w(T), T = k d + k₃ d³") {
  const WoundSpring law{{300, 4, 2e3}, Of::torque, table};
  for (double x = -0.6; x < 0.6; x += 0.013) {
    const double d = law.deflection(x, {}, {}), T = 300 * d + 2e3 * d * d * d;
    CHECK(std::abs(d + table(T).y - x) < 1e-14);
    CHECK(respond(law, x, 0, {}).force == near(T, 1e-12));
  }
}

TEST_CASE("A table gives way to another one linearly over its duration about the instant") {
  const TabulatedTorque law{Of::angle, {{{-1, 1}, {-2, 2}}, {{-1, 1}, {5, 5}}, 3.0, 0.2}};
  const auto force = [&](double t) { return law.respond(0.5, 0, {}, {.time = t}).force; };
  for (double t : {0.0, 2.9}) CHECK(force(t) == near(1, 1e-12));
  for (double t : {3.1, 9.0}) CHECK(force(t) == near(5, 1e-12));
  CHECK(force(2.95) == near(2, 1e-12));
  CHECK(force(3.0) == near(3, 1e-12));
}

TEST_CASE("A windup of the torque balances at every instant of its change") {
  const WoundSpring law{{300, 4, 2e3}, Of::torque, {table, soft, 1.0, 0.5}};
  for (double t : {0.0, 0.9, 1.1, 2.0}) {
    const double d = law.deflection(0.3, {}, {.time = t}), T = 300 * d + 2e3 * d * d * d;
    CHECK(std::abs(d + law.windup.at(t)(T).y - 0.3) < 1e-14);
    CHECK(respond(law, 0.3, 0, {}, {.time = t}).force == near(T, 1e-12));
  }
}

TEST_CASE("What the past does to force and state, and the present to the state, are derivatives too") {
  const LawMemory memory{.x = 0.02, .z = 0.03};
  const auto close = [](double found, double expected) { return std::abs(found - expected) < 1e-8; };
  for (const JointLaw& law : all_laws) {
    for (double x : {-0.07, 0.05}) {
      for (double v : {-0.6, 0.4}) {
        const auto at = [&](double dx, double dv, double dx0, double dz0) {
          return respond(law, x + dx, v + dv, {.x = memory.x + dx0, .z = memory.z + dz0});
        };
        const LawResponse r = at(0, 0, 0, 0);
        CAPTURE(law.index());
        CAPTURE(x);
        CAPTURE(v);
        CHECK(close(r.force_by_x0, derivative([&](double d) { return at(0, 0, d, 0).force; }, 0, 1e-4)));
        CHECK(close(r.force_by_z0, derivative([&](double d) { return at(0, 0, 0, d).force; }, 0, 1e-4)));
        CHECK(close(r.z_by_x, derivative([&](double d) { return at(d, 0, 0, 0).z; }, 0, 1e-4)));
        CHECK(close(r.z_by_rate, derivative([&](double d) { return at(0, d, 0, 0).z; }, 0, 1e-4)));
        CHECK(close(r.z_by_x0, derivative([&](double d) { return at(0, 0, d, 0).z; }, 0, 1e-4)));
        CHECK(close(r.z_by_z0, derivative([&](double d) { return at(0, 0, 0, d).z; }, 0, 1e-4)));
      }
    }
  }
}

TEST_CASE("What a law does not dissipate it stores: Q − loss is the derivative of its energy") {
  const LawMemory memory{.x = 0.02, .z = 0.03};
  for (const JointLaw& law : all_laws) {
    const auto energy = [&](double y) { return respond(law, y, 0.4, memory).energy; };
    for (double x : {-0.07, 0.03, 0.11}) {
      const LawResponse r = respond(law, x, 0.4, memory);
      CAPTURE(law.index());
      CHECK(std::abs(r.force - r.loss - derivative(energy, x, 1e-4)) <
            1e-8 * std::max(1.0, std::abs(r.force)));
    }
  }
}

TEST_CASE("Every law refuses a negative coefficient and says which") {
  const auto refuses = [](const JointLaw& law, const char* what) {
    CHECK_THROWS_WITH_AS(check(law), doctest::Contains(what), flexarm::InvalidParameter);
  };
  refuses(ReducerSpring{-3}, "joint stiffness must be positive, got -3");
  refuses(ReducerSpring{std::nan("")}, "joint stiffness must be positive");
  refuses(ReducerSpring{3, -1}, "joint damping must not be negative");
  refuses(ReducerSpring{3, 0, -1}, "cubic stiffness must not be negative");
  refuses(ReducerSpring{3, 0, 0, -1e-3}, "gap of the backlash must not be negative");
  refuses(ReducerSpring{3, 0, 0, 1e-3, 0}, "width over which contact damping fades must be positive");
  refuses(ReducerSpring{.stiffness = 3, .loose_stiffness = 0}, "stiffness left in the gap must be a part");
  refuses(ReducerSpring{.stiffness = 3, .loose_damping = 1.5}, "damping left in the gap must be a part");
  refuses(CableTorque{-1}, "stiffness of the cables must not be negative");
  refuses(ViscousFriction{-1}, "viscous friction must not be negative");
  refuses(DahlFriction{-1, 0.1}, "friction torque must not be negative");
  refuses(DahlFriction{1, 0}, "friction width must be positive");
  refuses(LugreFriction{0, 1, 1, 1, 1, 1}, "bristle stiffness must be positive");
  refuses(LugreFriction{1, -1, 1, 1, 1, 1}, "bristle damping must not be negative");
  refuses(LugreFriction{1, 1, -1, 1, 1, 1}, "viscous friction must not be negative");
  refuses(LugreFriction{1, 1, 1, 0, 1, 1}, "friction torque must be positive");
  refuses(LugreFriction{1, 1, 1, 2, 1, 1}, "break-away torque must not be below the friction torque");
  refuses(LugreFriction{1, 1, 1, 1, 1, 0}, "Stribeck rate must be positive");
  refuses(TabulatedTorque{Of::torque, table}, "a torque is a table of angle, rate or motor angle");
  refuses(TabulatedFriction{table, 0}, "friction width must be positive");
  refuses(TabulatedTorque{Of::angle, {table, table, 1, 0}}, "must change over a positive duration, got 0");
  refuses(WoundSpring{{300}, Of::torque, {table, {{0, 1}, {0, -1.0 / 299}}, 1, 1}}, "leaves it no stiffness");
  refuses(WoundSpring{{300}, Of::motor_angle, table}, "the teeth wind up with the motor's angle");
  refuses(WoundSpring{{-3}, Of::torque, table}, "joint stiffness must be positive");
  refuses(WoundSpring{{300}, Of::torque, MonotoneCubic({0, 1}, {0, -1.0 / 299})}, "leaves it no stiffness");
  const OilColumn oil{1e6, 0.02, 0.01, 1e-3, 0.05, 0.4, 4};
  const auto column = [&](double OilColumn::* key, double value) {
    OilColumn changed = oil;
    changed.*key = value;
    return changed;
  };
  refuses(column(&OilColumn::bulk_modulus, 0), "bulk modulus of the oil must be positive, got 0");
  refuses(column(&OilColumn::piston_area, -1), "area of the piston must be positive, got -1");
  refuses(column(&OilColumn::ring_area, -1), "area of the ring must not be negative, got -1");
  refuses(column(&OilColumn::dead_volume, 0), "dead volume must be positive, got 0");
  refuses(column(&OilColumn::stroke, 0), "stroke must be positive, got 0");
  refuses(column(&OilColumn::damping, -1), "damping of the oil column must not be negative, got -1");
  refuses(EndCushion{0.1, 0.1, 1, 0.01, 0}, "upper end must lie above the lower one, got 0.1");
  refuses(EndCushion{0, 0.1, 0, 0.01, 0}, "stiffness of the ends must be positive, got 0");
  refuses(EndCushion{0, 0.1, 1, 0.06, 0}, "length of the cushions must be positive and at most half");
  refuses(EndCushion{0, 0.1, 1, 0.01, -1}, "damping of the cushions must not be negative, got -1");
  for (const auto* laws : {&all_laws, &laws_of_two}) {
    for (const JointLaw& law : *laws) CHECK_NOTHROW(check(law));
  }
}

TEST_CASE("A cushion resists on the way to its end only, and an oil column is stiff at its ends") {
  const EndCushion ends{.low = -1, .high = 1, .stiffness = 50, .length = 0.2, .damping = 8};
  CHECK(ends.respond(0.9, 2, {}).force == near(8 * 0.5 * 2, 1e-14));  // half way: g = 1/2
  CHECK(ends.respond(-0.9, -2, {}).force == near(-8 * 0.5 * 2, 1e-14));
  CHECK(ends.respond(1.1, -2, {}).force == near(50 * 0.1, 1e-14));
  for (double x : {-0.7, 0.0, 0.7}) CHECK(ends.respond(x, 2, {}).force == 0);
  const OilColumn oil{1e9, 8e-3, 8e-3, 4e-4, 0.1, 0.8};
  const auto k = [&](double stroke) { return oil.respond(0, 0, {}, {.value = stroke}).stiffness; };
  CHECK(k(0.5) == near(2 * 1e9 * 8e-3 * 8e-3 / (4e-4 + 8e-3 * 0.4), 1e-14));
  CHECK(k(0.1) == near(k(0.9), 1e-14));
  CHECK(k(-3) == near(k(0.1), 1e-14));
  CHECK(k(0.3) > k(0.5));
}

TEST_CASE("A pin presses on its hole along its eccentricity, and rests in the middle without a force") {
  const RadialClearance pin{{.stiffness = 1e4, .gap = 0.02, .loose_stiffness = 1e-4}};
  const double x = 0.012, y = 0.016;  // e = 0.02, twice the clearance
  const double F = 1e4 * 0.01 + 1 * 0.01;
  CHECK(pin.respond(x, 0, {}, {.value = y}).force == near(0.6 * F, 1e-13));
  CHECK(pin.respond(y, 0, {}, {.value = x}).force == near(0.8 * F, 1e-13));
  CHECK(pin.respond(0, 0, {}, {}).force == 0);
  CHECK(pin.respond(0, 0, {}, {}).stiffness == near(1, 1e-13));
  CHECK(pin.opened(x, y) == near(1.5, 1e-13));
}

TEST_CASE("Only friction stays out of statics") {
  for (const JointLaw& law : all_laws) {
    const bool friction = std::holds_alternative<DahlFriction>(law) ||
                          std::holds_alternative<LugreFriction>(law) ||
                          std::holds_alternative<TabulatedFriction>(law);
    CHECK(acts_at_rest(law) != friction);
  }
}

}  // namespace flexarm::tests::joint_law_test
