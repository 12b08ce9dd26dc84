#include "flexarm/simulation/spline_fit.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>

#include "flexarm/errors.hpp"
#include "numerics.hpp"

namespace flexarm::tests::spline_fit_test {

using flexarm::simulation::spline_equations;
using flexarm::simulation::spline_values;
using flexarm::tests::Random;
using flexarm::tests::VectorXd;
using Breaks = Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>;

namespace {

const Breaks breaks{{0, 2, 5, 6, 13, 20}};

VectorXd uneven_samples(Random& random) {
  VectorXd time(21);
  time[0] = -1;
  for (Eigen::Index k = 1; k < time.size(); ++k) time[k] = time[k - 1] + random(0.05, 1);
  return time;
}

/// The coefficients that solve (1).
VectorXd fitted(const VectorXd& time, const VectorXd& values) {
  const auto [band, right] = spline_equations(time, values, breaks);
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(right.size(), right.size());
  for (Eigen::Index j = 0; j < right.size(); ++j) {
    for (Eigen::Index below = 0; below < 4 && j + below < right.size(); ++below) {
      lower(j + below, j) = band(below, j);
    }
  }
  return lower.selfadjointView<Eigen::Lower>().llt().solve(right);
}

}  // namespace

TEST_CASE("B-splines add up to one") {
  Random random(1);
  const VectorXd values = spline_values(uneven_samples(random), breaks, VectorXd::Ones(8));
  CHECK((values.array() - 1).abs().maxCoeff() < 1e-14);
}

TEST_CASE("A least-squares spline repeats a cubic polynomial") {
  Random random(2);
  const VectorXd time = uneven_samples(random);
  const VectorXd values = time.array().cube() - 2 * time.array() + 1;
  CHECK((spline_values(time, breaks, fitted(time, values)) - values).norm() < 1e-11 * values.norm());
}

TEST_CASE("The residual of a least-squares spline is normal to every spline") {
  Random random(3);
  const VectorXd time = uneven_samples(random), values = random.vector(21);
  const VectorXd residual = values - spline_values(time, breaks, fitted(time, values));
  CHECK(residual.norm() > 0.1);
  CHECK(spline_equations(time, residual, breaks).right.norm() < 1e-12);
}

TEST_CASE("Breaks that do not run from the first sample to the last are refused") {
  const VectorXd time = VectorXd::LinSpaced(21, 0, 1);
  for (const Breaks& wrong : {Breaks{{0, 2, 19}}, Breaks{{1, 20}}, Breaks{{0, 5, 5, 20}}, Breaks{{20}}}) {
    CHECK_THROWS_AS(spline_equations(time, time, wrong), flexarm::InvalidParameter);
  }
  CHECK_THROWS_AS(spline_equations(time, time.head(20), breaks), flexarm::InvalidParameter);
  CHECK_THROWS_AS(spline_values(time, breaks, time), flexarm::InvalidParameter);
}

}  // namespace flexarm::tests::spline_fit_test
