#include "flexarm/simulation/piecewise_polynomial.hpp"

#include <doctest/doctest.h>

#include "flexarm/errors.hpp"
#include "numerics.hpp"

namespace flexarm::tests::piecewise_polynomial_test {

using flexarm::InvalidParameter;
using flexarm::simulation::PiecewisePolynomial;
using flexarm::tests::near;

namespace {

/// 2 + 3 x − x² + x³/2 on [1, 3), then 1 − 2 x on [3, 4], x from the start of each.
PiecewisePolynomial example() {
  Eigen::MatrixXd c(4, 2);
  c << 0.5, 0, -1, 0, 3, -2, 2, 1;
  return {{1, 3, 4}, c};
}

}  // namespace

TEST_CASE("Value and derivatives are those of the polynomial of the interval") {
  const auto f = example();
  const auto [value, first, second] = f(2.5);
  CHECK(value == near(2 + 4.5 - 2.25 + 0.5 * 3.375));
  CHECK(first == near(3 - 3 + 1.5 * 2.25));
  CHECK(second == near(-2 + 3 * 1.5));
  CHECK(f(3)[0] == near(1));  // breaks belong to what follows
  CHECK(f(3)[1] == near(-2));
  CHECK(f(1)[0] == near(2));
  CHECK(f(4)[0] == near(-1));
  CHECK(f(4)[1] == near(-2));
}

TEST_CASE("Outside, the end values are held at rest") {
  const auto f = example();
  CHECK(f(0)[0] == near(2));
  CHECK(f(9)[0] == near(-1));
  for (double t : {0.0, 9.0}) {
    CHECK(f(t)[1] == 0);
    CHECK(f(t)[2] == 0);
  }
  CHECK(PiecewisePolynomial::constant(7)(-3)[0] == 7);
  CHECK(PiecewisePolynomial::constant(7)(0.5)[0] == 7);
  CHECK(PiecewisePolynomial::constant(7)(0.5)[1] == 0);
}

TEST_CASE("Nothing given is zero at all times") {
  const auto [value, first, second] = PiecewisePolynomial{}(3);
  CHECK(value == 0);
  CHECK(first == 0);
  CHECK(second == 0);
}

TEST_CASE("Shapes that do not fit and breaks that do not rise are refused") {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(3, 1), two = Eigen::MatrixXd::Ones(3, 2);
  CHECK_THROWS_AS(PiecewisePolynomial({0, 1}, two), InvalidParameter);
  CHECK_THROWS_AS(PiecewisePolynomial({0}, Eigen::MatrixXd(3, 0)), InvalidParameter);
  CHECK_THROWS_AS(PiecewisePolynomial({1, 0}, one), InvalidParameter);
  CHECK_THROWS_AS(PiecewisePolynomial({0, 1, 1}, two), InvalidParameter);
  CHECK_THROWS_AS(PiecewisePolynomial({0, 1}, Eigen::MatrixXd(0, 1)), InvalidParameter);
}

}  // namespace flexarm::tests::piecewise_polynomial_test
