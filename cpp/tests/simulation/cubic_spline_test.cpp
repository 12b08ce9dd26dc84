#include "flexarm/simulation/cubic_spline.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "flexarm/errors.hpp"
#include "numerics.hpp"

namespace flexarm::tests::cubic_spline_test {

using flexarm::InvalidParameter;
using flexarm::simulation::cubic_spline;
using flexarm::tests::near;
using flexarm::tests::Random;
using flexarm::tests::VectorXd;

namespace {

/// Instants whose steps differ by up to a factor of twenty.
VectorXd uneven_instants(Eigen::Index n, Random& random) {
  VectorXd x(n);
  x[0] = random(-2, 2);
  for (Eigen::Index k = 1; k < n; ++k) x[k] = x[k - 1] + random(0.05, 1);
  return x;
}

/// Value and three derivatives at the end of an interval of length h.
Eigen::Vector4d at_end(const Eigen::Vector4d& c, double h) {
  return {((c[0] * h + c[1]) * h + c[2]) * h + c[3], (3 * c[0] * h + 2 * c[1]) * h + c[2],
          6 * c[0] * h + 2 * c[1], 6 * c[0]};
}

}  // namespace

TEST_CASE("The spline passes through its samples, and neither slope nor curvature jumps") {
  Random random(5);
  for (Eigen::Index n : {4, 5, 6, 40}) {
    const VectorXd x = uneven_instants(n, random), y = random.vector(n);
    const Eigen::MatrixXd c = cubic_spline(x, y);
    CHECK(c.rows() == 4);
    REQUIRE(c.cols() == n - 1);
    for (Eigen::Index k = 0; k + 1 < n; ++k) {
      const Eigen::Vector4d end = at_end(c.col(k), x[k + 1] - x[k]);
      CHECK(c(3, k) == y[k]);
      CHECK(end[0] == near(y[k + 1]));
      if (k + 2 < n) {
        // Curvatures of samples of size 1 at steps of 0.05 reach 1e3, their rounding 1e-12.
        CHECK(std::abs(end[1] - c(2, k + 1)) < 1e-11);
        CHECK(std::abs(end[2] - 2 * c(1, k + 1)) < 1e-9);
      }
    }
    CHECK(c(0, 0) == near(c(0, 1), 1e-9));  // no knot at the second sample
    CHECK(c(0, n - 2) == near(c(0, n - 3), 1e-9));
  }
}

TEST_CASE("A cubic is its own spline, whatever the instants") {
  Random random(6);
  const VectorXd x = uneven_instants(12, random);
  const VectorXd y = x.unaryExpr([](double t) { return 2 - t + 0.5 * t * t - 0.25 * t * t * t; });
  const Eigen::MatrixXd c = cubic_spline(x, y);
  for (Eigen::Index k = 0; k < c.cols(); ++k) {
    CHECK(c(2, k) == near(-1 + x[k] - 0.75 * x[k] * x[k], 1e-9));
    CHECK(c(1, k) == near(0.5 - 0.75 * x[k], 1e-9));
    CHECK(c(0, k) == near(-0.25, 1e-9));
  }
}

TEST_CASE("Two samples are joined by a line, three by a parabola") {
  const Eigen::MatrixXd line = cubic_spline(Eigen::Vector2d(1, 3), Eigen::Vector2d(5, 9));
  CHECK(line == Eigen::Vector4d(0, 0, 2, 5));
  // y = 1 + 2 x + 3 x² at 0, 1 and 3
  const Eigen::MatrixXd parabola = cubic_spline(Eigen::Vector3d(0, 1, 3), Eigen::Vector3d(1, 6, 34));
  CHECK((parabola.col(0) - Eigen::Vector4d(0, 3, 2, 1)).norm() < 1e-14);
  CHECK((parabola.col(1) - Eigen::Vector4d(0, 3, 8, 6)).norm() < 1e-14);
}

TEST_CASE("Samples that are too few or do not belong together are refused") {
  CHECK_THROWS_AS(cubic_spline(VectorXd::Zero(1), VectorXd::Zero(1)), InvalidParameter);
  CHECK_THROWS_AS(cubic_spline(VectorXd::Zero(4), VectorXd::Zero(3)), InvalidParameter);
}

}  // namespace flexarm::tests::cubic_spline_test
