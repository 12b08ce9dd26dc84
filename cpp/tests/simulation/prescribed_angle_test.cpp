#include "flexarm/simulation/prescribed_angle.hpp"

#include <doctest/doctest.h>

#include "numerics.hpp"

namespace flexarm::tests::prescribed_angle_test {

using namespace flexarm::simulation;

namespace {

/// Largest error of the rate along sin 3t, 2 s at steps of h, once the start is forgotten.
double rate_error(double h) {
  PrescribedAngle now{{0, 3, 0}, 0};
  double worst = 0;
  for (int k = 1; k * h < 2; ++k) {
    now = now.reach(std::sin(3 * k * h), h);
    if (k * h > 0.5) worst = std::max(worst, std::abs(now.motion.v - 3 * std::cos(3 * k * h)));
  }
  return worst;
}

}  // namespace

TEST_CASE("Rates of an angle known at steps only are of order two") {
  CHECK(rate_error(0.02) / rate_error(0.01) == near(4, 0.1));
  CHECK(rate_error(0.01) < 5e-4);  // (h²/6 + h²/12 ...) 27: a few h² times the third derivative
}

TEST_CASE("A wrong acceleration falls to a half in each step instead of ringing on") {
  PrescribedAngle now{{0, 0, 1.0}, 1.0};  // the angle stands still, its acceleration claims otherwise
  double last = 0;
  for (int k = 0; k < 20; ++k) {
    now = now.reach(0, 1e-3);
    last = std::abs(now.a);
  }
  CHECK(last < 20 * 20 * std::pow(0.5, 20));  // powers of k from the triple root
  CHECK(std::abs(now.motion.v) < 1e-6);
}

TEST_CASE("The quintic has value, rate and acceleration of both ends, and these are its derivatives") {
  const Motion a{0.3, -1.2, 4.0}, b{0.5, 0.7, -2.0};
  const double h = 0.4;
  const auto same = [](const Motion& p, const Motion& q) {
    return std::abs(p.s - q.s) + std::abs(p.v - q.v) + std::abs(p.v_dot - q.v_dot) < 1e-12;
  };
  CHECK(same(quintic(a, b, h, 0), a));
  CHECK(same(quintic(a, b, h, 1), b));
  const double x = 0.37, e = 1e-5;
  const Motion before = quintic(a, b, h, x - e), after = quintic(a, b, h, x + e), now = quintic(a, b, h, x);
  CHECK((after.s - before.s) / (2 * e * h) == near(now.v, 1e-7));
  CHECK((after.v - before.v) / (2 * e * h) == near(now.v_dot, 1e-7));
}

}  // namespace flexarm::tests::prescribed_angle_test
