#include "flexarm/simulation/motion_samples.hpp"

#include <doctest/doctest.h>

#include "flexarm/errors.hpp"
#include "numerics.hpp"

namespace flexarm::tests::motion_samples_test {

using flexarm::simulation::sample_motion;
using flexarm::simulation::SampledValues;
using flexarm::tests::error;
using flexarm::tests::VectorXd;

namespace {

const VectorXd times{{-0.5, 0, 0.3, 1, 1.1}};
const VectorXd instants{{0.2, -0.5, 1.05, 0.3, 0.7, 1.1, -0.1}};  // in no order

const SampledValues none;

SampledValues columns(const VectorXd& a, const VectorXd& b) {
  SampledValues found(a.size(), 2);
  found << a, b;
  return found;
}

VectorXd cubic(const VectorXd& t) { return 2 * t.array().cube() - t.array().square() + 3; }
VectorXd cubic_rate(const VectorXd& t) { return 6 * t.array().square() - 2 * t.array(); }

}  // namespace

TEST_CASE("A cubic motion with its rates is met between the steps") {
  const SampledValues values = columns(cubic(times), times),
                      rates = columns(cubic_rate(times), VectorXd::Ones(5));
  const auto found = sample_motion(times, values, rates, instants, 0.0);
  CHECK(error(found, columns(cubic(instants), instants)) < 1e-14);
}

TEST_CASE("Without rates a parabola is met between inner steps") {
  const VectorXd inner{{0.1, 0.5, 0.9}};
  const VectorXd values = times.array().square();
  CHECK(error(sample_motion(times, values, none, inner, 0.0), inner.array().square().matrix()) < 1e-14);
}

TEST_CASE("At the steps values are met to the last digit") {
  const SampledValues values = columns(cubic(times), times / 3);
  CHECK(sample_motion(times, values, none, times, 0.0) == values);
  CHECK(sample_motion(times, values, values, times, 0.0) == values);
}

TEST_CASE(
    "Before the first step a motion goes on with its first rate for a while, after the last it is unknown") {
  const VectorXd rates = VectorXd::Constant(5, 2.0), outside{{-0.6, -2, 1.2, 1.1 + 1e-10}};
  const auto found = sample_motion(times, times, rates, outside, 0.2);
  CHECK(std::abs(found(0, 0) - (-0.5 - 2 * 0.1)) < 1e-15);
  CHECK(std::abs(found(1, 0) - (-0.5 - 2 * 0.2)) < 1e-15);
  CHECK(std::isnan(found(2, 0)));
  CHECK(found(3, 0) == 1.1);
  CHECK(sample_motion(times, times, none, outside, 0.2)(1, 0) == -0.5);
}

TEST_CASE("A single instant stands for all before it") {
  const VectorXd one{{1.0}}, value{{4.0}};
  const auto found = sample_motion(one, value, none, VectorXd{{0, 1, 2}}, 0.1);
  CHECK(found(0, 0) == 4);
  CHECK(found(1, 0) == 4);
  CHECK(std::isnan(found(2, 0)));
}

TEST_CASE("Values that are not one at each time are refused") {
  CHECK_THROWS_AS(sample_motion(times, instants, none, instants, 0.0), flexarm::InvalidParameter);
  CHECK_THROWS_AS(sample_motion(times, times, instants, instants, 0.0), flexarm::InvalidParameter);
}

}  // namespace flexarm::tests::motion_samples_test
