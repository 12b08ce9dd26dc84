#include "flexarm/integrators/law_equations.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "arms.hpp"

namespace flexarm::tests::law_equations_test {

using flexarm::integrators::law_forces;
using flexarm::integrators::LawHere;
using flexarm::joints::DahlFriction;
using flexarm::joints::JointLaw;
using flexarm::joints::LugreFriction;

namespace {

const JointLaw teeth = ReducerSpring{.stiffness = 1e5, .gap = 1e-3};
const JointLaw stiffening = ReducerSpring{.stiffness = 1e5, .cubic_stiffness = 1e11};
const JointLaw friction = DahlFriction{.torque = 300, .width = 2e-5};
const JointLaw bristles = LugreFriction{3e6, 0, 10, 100, 100, 0.01};

/// A law somewhere on its way, so far from the end of the step that all of it can happen there. Bristles bend
/// by up to 3e-5 rad, Dahl's z goes up to one.
LawHere somewhere(const JointLaw& law, Random& random) {
  const VectorXd u = random.vector(3);
  const double bent = std::holds_alternative<LugreFriction>(law) ? 3e-5 : 1;
  return {.law = &law,
          .memory = {2e-3 * u[0], 0.9 * bent * u[1]},
          .x = 2e-3 * u[0] + 1e-3 * u[2],
          .rate = 0.3 * u[1],
          .rate_by_x = 500,
          .kept = 4e4};
}

/// w + G q(w) = z of one law by halving the interval that holds w: q + κ w, all that the law puts against w,
/// has the sign of w.
double halved(double G, double z, const LawHere& law) {
  const double largest = z / (1 - G * law.kept);
  double low = std::min(0.0, largest), high = std::max(0.0, largest);
  for (int k = 0; k < 200; ++k) {
    const double w = 0.5 * (low + high);
    (w + G * law.change(w).force > z ? high : low) = w;
  }
  return 0.5 * (low + high);
}

}  // namespace

TEST_CASE("Deflections are those that halving an interval finds, for soft and for stiff arms") {
  Random random(11);
  for (const JointLaw& law : {teeth, stiffening, friction, bristles}) {
    CAPTURE(law.index());
    for (int trial = 0; trial < 200; ++trial) {
      const LawHere here = somewhere(law, random);
      const double G = std::pow(10, -5.5 + random.vector(1)[0]);  // within a factor of ten, G κ < 1
      if (G * here.kept > 0.95) continue;
      const double z = 3e-3 * random.vector(1)[0];
      using One = Eigen::Matrix<double, 1, 1>;
      const double f = law_forces(One(G), One(z), {here})[0];
      const double w = halved(G, z, here);
      CHECK(std::abs(z - G * f - w) < 1e-12);
      CHECK(std::abs(f - here.change(w).force) < 1e-6 * (1 + std::abs(f)));
    }
  }
}

TEST_CASE("A law on its tangent takes the force that the tangent gives, to rounding") {
  const JointLaw spring = ReducerSpring{.stiffness = 1e5};
  const LawHere here{.law = &spring, .memory = {}, .x = 1e-3, .rate = 0, .rate_by_x = 500, .kept = 4e4};
  using One = Eigen::Matrix<double, 1, 1>;
  const double G = 3e-6, z = 2e-3, w = z / (1 + G * 6e4);
  CHECK(law_forces(One(G), One(z), {here})[0] == near(6e4 * w, 1e-12));
}

TEST_CASE("Several laws that lean on one another satisfy their equations, whatever the size is known by") {
  Random random(12);
  for (int trial = 0; trial < 200; ++trial) {
    const std::vector<LawHere> laws = {somewhere(teeth, random), somewhere(friction, random)};
    const Eigen::Matrix2d root = 1e-3 * (Eigen::Map<const Eigen::Matrix2d>(random.vector(4).data()) +
                                         1.5 * Eigen::Matrix2d::Identity());
    const Eigen::Matrix2d G = root * root.transpose();
    const Eigen::Vector2d z = 3e-3 * random.vector(2);
    const Eigen::Vector2d f = law_forces(G, z, laws), w = z - G * f;
    for (int k = 0; k < 2; ++k)
      CHECK(std::abs(f[k] - laws[k].change(w[k]).force) < 1e-6 * (1 + std::abs(f[k])));
    const VectorXd same = law_forces(MatrixXd(G), VectorXd(z), laws);
    CHECK(relative_error(same, VectorXd(f)) < 1e-9);
  }
}

TEST_CASE("Where laws fall, as friction at a growing rate and damped teeth that part, forces are finite") {
  const JointLaw falling = LugreFriction{3e6, 2e3, 0, 50, 300, 0.005};
  const JointLaw parting = ReducerSpring{.stiffness = 1e5, .damping = 200, .gap = 1e-3};
  Random random(13);
  for (const JointLaw& law : {falling, parting}) {
    for (int trial = 0; trial < 200; ++trial) {
      const LawHere here = somewhere(law, random);
      using One = Eigen::Matrix<double, 1, 1>;
      CHECK(std::isfinite(law_forces(One(2e-5), One(3e-3 * random.vector(1)[0]), {here})[0]));
    }
  }
}

}  // namespace flexarm::tests::law_equations_test
