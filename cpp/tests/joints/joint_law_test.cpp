#include "flexarm/joints/joint_law.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "flexarm/errors.hpp"
#include "numerics.hpp"

// Designated initialisers name what matters to a test and leave the rest at its default on purpose.
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"

using flexarm::tests::near;
using namespace flexarm::joints;
using flexarm::tests::derivative;

namespace {

const std::vector<JointLaw> all_laws = {
    ReducerSpring{300, 4, 2e3},
    ReducerSpring{.stiffness = 300, .damping = 4, .gap = 0.11, .fade_width = 0.02},
    CableTorque{70, 0.3},
    ViscousFriction{0.8},
    DahlFriction{2.5, 0.05},
    LugreFriction{50, 0.9, 0.4, 2.0, 3.0, 0.5}};
static_assert(std::variant_size_v<JointLaw> == 5, "a new law joins all_laws");

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
      CHECK(std::abs(r.force - r.loss - derivative(energy, x, 1e-3)) <
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
  for (const JointLaw& law : all_laws) CHECK_NOTHROW(check(law));
}

TEST_CASE("Only friction stays out of statics") {
  for (const JointLaw& law : all_laws) {
    const bool friction =
        std::holds_alternative<DahlFriction>(law) || std::holds_alternative<LugreFriction>(law);
    CHECK(acts_at_rest(law) != friction);
  }
}
