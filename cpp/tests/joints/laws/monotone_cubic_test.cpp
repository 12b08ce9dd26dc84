#include "flexarm/joints/laws/monotone_cubic.hpp"

#include <doctest/doctest.h>

#include "flexarm/errors.hpp"
#include "numerics.hpp"

namespace flexarm::tests::monotone_cubic_test {

using flexarm::InvalidParameter;
using flexarm::joints::MonotoneCubic;
using flexarm::tests::derivative;
using flexarm::tests::near;

namespace {

const MonotoneCubic table({-1.0, 0.5, 1.0, 3.0, 3.5}, {2.0, 1.0, 1.0, 4.0, 0.0});

}  // namespace

TEST_CASE("A table goes through its knots, never beyond the values beside, and holds the last") {
  CHECK(table(-1).y == 2);
  CHECK(table(1).y == 1);
  CHECK(table(3.5).y == near(0, 1e-15));
  for (double x = 0.5; x <= 1; x += 0.01) CHECK(table(x).y == near(1));
  for (double x = 1; x < 3; x += 0.01) CHECK(table(x).first >= 0);
  CHECK(table(-7).y == 2);
  CHECK(table(-7).first == 0);
  CHECK(table(9).y == 0);
  CHECK(table.range() == std::pair(0.0, 4.0));
}

TEST_CASE("y' and y'' are the derivatives of y, and y that of the integral, which is zero at 0") {
  for (double x : {-0.7, 0.2, 1.7, 3.2}) {
    CHECK(table(x).first == near(derivative([&](double u) { return table(u).y; }, x, 1e-3), 1e-8));
    CHECK(table(x).second == near(derivative([&](double u) { return table(u).first; }, x, 1e-3), 1e-8));
  }
  for (double x : {-3.0, -0.7, 0.2, 1.7, 5.0}) {
    CHECK(std::abs(table(x).y - derivative([&](double u) { return table.integral(u); }, x, 1e-3)) < 1e-9);
  }
  CHECK(table.integral(0) == 0);
}

TEST_CASE("Slopes of a table are the least and the largest of any place") {
  double least = 0, most = 0;
  for (double x = -1; x <= 3.5; x += 1e-4) {
    least = std::min(least, table(x).first);
    most = std::max(most, table(x).first);
  }
  CHECK(table.slopes().first == near(least, 1e-6));
  CHECK(table.slopes().second == near(most, 1e-6));
}

TEST_CASE("Two knots are a line, and three on a line are that line") {
  const MonotoneCubic two({0, 2}, {1, 5}), three({0, 0.3, 2}, {1, 1.6, 5});
  for (double x : {0.1, 0.7, 1.9}) {
    CHECK(two(x).y == near(1 + 2 * x));
    CHECK(three(x).y == near(1 + 2 * x));
  }
}

TEST_CASE("Tables that do not rise, are not finite or not of one length are refused") {
  CHECK_THROWS_WITH_AS(MonotoneCubic({0, 0}, {1, 2}), doctest::Contains("must rise"), InvalidParameter);
  CHECK_THROWS_WITH_AS(MonotoneCubic({0, 1}, {1, std::nan("")}), doctest::Contains("finite"),
                       InvalidParameter);
  CHECK_THROWS_WITH_AS(MonotoneCubic({0, 1}, {1}), doctest::Contains("as many values"), InvalidParameter);
  CHECK_THROWS_WITH_AS(MonotoneCubic({0}, {1}), doctest::Contains("two or more"), InvalidParameter);
}

}  // namespace flexarm::tests::monotone_cubic_test
