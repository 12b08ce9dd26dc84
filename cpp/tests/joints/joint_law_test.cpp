#include "flexarm/joints/joint_law.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "flexarm/errors.hpp"
#include "numerics.hpp"

using flexarm::tests::near;
using namespace flexarm::joints;
using flexarm::tests::derivative;

namespace {

const std::vector<JointLaw> all_laws = {LinearSpring{300, 4}, CubicSpring{2e3}, ViscousFriction{0.8},
                                        DahlFriction{2.5, 0.05}};
static_assert(std::variant_size_v<JointLaw> == 4, "a new law joins all_laws");

}  // namespace

TEST_CASE("Stiffness and damping of every law are the derivatives of its force") {
  const LawMemory memory{0.02, 0.3};
  for (const JointLaw& law : all_laws) {
    for (double x : {-0.07, 0.05, 0.3}) {
      const double x_dot = 0.4;
      const auto by_x = [&](double y) { return respond(law, y, x_dot, memory).force; };
      const auto by_rate = [&](double y) { return respond(law, x, y, memory).force; };
      const LawResponse r = respond(law, x, x_dot, memory);
      CAPTURE(law.index());
      CAPTURE(x);
      CHECK(r.stiffness == near(derivative(by_x, x, 1e-4), 1e-8));
      CHECK(r.damping == near(derivative(by_rate, x_dot, 1e-2), 1e-8));
    }
  }
}

TEST_CASE("What a law does not dissipate it stores: Q − loss is the derivative of its energy") {
  const LawMemory memory{0.02, 0.3};
  for (const JointLaw& law : all_laws) {
    const auto energy = [&](double y) { return respond(law, y, 0.4, memory).energy; };
    const LawResponse r = respond(law, 0.11, 0.4, memory);
    CAPTURE(law.index());
    CHECK(r.force - r.loss == near(derivative(energy, 0.11, 1e-3), 1e-8));
  }
}

TEST_CASE("Every law refuses a negative coefficient and says which") {
  CHECK_THROWS_WITH_AS(check(LinearSpring{-3, 0}),
                       doctest::Contains("joint stiffness must be positive, got -3"),
                       flexarm::InvalidParameter);
  CHECK_THROWS_AS(check(LinearSpring{3, -1}), flexarm::InvalidParameter);
  CHECK_THROWS_AS(check(CubicSpring{-1}), flexarm::InvalidParameter);
  CHECK_THROWS_AS(check(ViscousFriction{-1}), flexarm::InvalidParameter);
  CHECK_THROWS_AS(check(DahlFriction{-1, 0.1}), flexarm::InvalidParameter);
  CHECK_THROWS_AS(check(DahlFriction{1, 0}), flexarm::InvalidParameter);
  CHECK_THROWS_AS(check(LinearSpring{std::nan(""), 0}), flexarm::InvalidParameter);
  for (const JointLaw& law : all_laws) CHECK_NOTHROW(check(law));
}

TEST_CASE("Only Dahl friction stays out of statics") {
  for (const JointLaw& law : all_laws) CHECK(acts_at_rest(law) != std::holds_alternative<DahlFriction>(law));
}
