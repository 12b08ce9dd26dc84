#include "flexarm/simulation/stepping.hpp"

#include <doctest/doctest.h>

#include <cstring>

#include "arms.hpp"
#include "flexarm/errors.hpp"
#include "flexarm/simulation/sampled_run.hpp"

namespace flexarm::tests::stepping_test {

using namespace flexarm::simulation;

namespace {

bool same_bits(const VectorXd& a, const VectorXd& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

bool same_bits(const State& a, const State& b) {
  for (std::size_t k = 0; k < a.frames.size(); ++k) {
    if (a.frames[k].R != b.frames[k].R || a.frames[k].x != b.frames[k].x) return false;
  }
  return same_bits(a.s, b.s) && same_bits(a.v, b.v) && same_bits(a.v_dot, b.v_dot) && same_bits(a.a, b.a) &&
         same_bits(a.multipliers, b.multipliers);
}

/// Two links, torque at the shoulder, the elbow told its angle: the matrix changes with the elbow.
System two_links() {
  return {two_link_arm(), {{"shoulder", DriveKind::torque}, {"elbow", DriveKind::motor_angle}}};
}

Moment rest(const System& system, Stepping& stepping) {
  const System held(two_link_arm(),
                    {{"shoulder", DriveKind::motor_angle}, {"elbow", DriveKind::motor_angle}});
  return stepping.start(released(held, static_equilibrium(held, {0.4, -0.3}, Loads{}), system));
}

std::vector<JointInput> inputs(long k) {
  const double t = 2e-3 * static_cast<double>(k);
  return {{40 * std::sin(9 * t)}, {-0.3 + 1.2 * t * t}};
}

Moment go(Stepping& stepping, Moment from, int n) {
  for (int k = 0; k < n; ++k) from = stepping.advance(from, inputs(from.steps + 1), {});
  return from;
}

}  // namespace

TEST_CASE("A step depends on the moment alone, to the last bit, whatever was stepped before") {
  const System system = two_links();
  Stepping stepping(system, 2e-3, -0.05);
  const Moment half = go(stepping, rest(system, stepping), 300);
  const Moment end = go(stepping, half, 300);
  CHECK(stepping.statistics().factorisations > 3);  // there was something to remember

  CHECK(same_bits(go(stepping, half, 300).state, end.state));  // back from far away
  Stepping other(system, 2e-3, -0.05);
  Moment stored = half;  // as from a file: the same numbers at another place
  stored.memory.factored = std::make_shared<const flexarm::integrators::Linearisation>(*half.memory.factored);
  CHECK(same_bits(go(other, stored, 300).state, end.state));
}

TEST_CASE("Angles with their rates step as a run along the same drive does") {
  const System system(paper_arm({.elements = 2, .hub_stiffness = 1e5}), {{"hinge", DriveKind::motor_angle}});
  const auto at_rest = static_equilibrium(system, {half_pi}, Loads{});
  Eigen::MatrixXd cubic(4, 1);
  cubic << 0.8, -0.4, 0, half_pi;
  const PiecewisePolynomial drive({0, 1}, cubic);
  const auto run = simulate(system, at_rest, {drive}, {.end = 0.4, .step = 2e-3});
  Stepping stepping(system, 2e-3, -0.05);
  Moment now = stepping.start(at_rest);
  for (int k = 1; k <= 200; ++k) {
    const auto [s, v, v_dot] = drive(2e-3 * k);
    now = stepping.advance(now, {{s, true, v, v_dot}}, {});
  }
  CHECK(now.state.t == near(0.4));
  CHECK(error(system.point_frame(now.state, 0).x, run.position.col(200)) < 1e-8);
}

TEST_CASE("A force that is held bends the arm to the equilibrium that statics finds") {
  const System system(paper_arm({.elements = 2, .damping_ratio = 0.3}), {{"hinge", DriveKind::motor_angle}});
  const auto at_rest = static_equilibrium(system, {half_pi}, Loads{});
  const std::vector<flexarm::assembly::PointLoad> push{{.point = 0, .force = {50, 20, 0}}};
  Stepping stepping(system, 0.01, -0.3);
  Moment now = stepping.start(at_rest);
  for (int k = 0; k < 1000; ++k) now = stepping.advance(now, {{half_pi}}, push);
  const auto pushed = static_equilibrium(system, {half_pi}, Loads{.points = push});
  const Vector3d tip = system.point_frame(pushed.state, 0).x;
  CHECK(error(system.point_frame(now.state, 0).x, tip) < 1e-7);
  CHECK((tip - system.point_frame(at_rest.state, 0).x).norm() > 5e-3);
}

TEST_CASE("What no step can be made of is refused and leaves the moment as it was") {
  const System system = two_links();
  CHECK_THROWS_AS(Stepping(system, 0, -0.05), flexarm::InvalidParameter);
  CHECK_THROWS_AS(Stepping(system, 1e-3, 0.1), flexarm::InvalidParameter);
  Stepping stepping(system, 2e-3, -0.05);
  const Moment start = rest(system, stepping);
  CHECK_THROWS_AS(stepping.advance(start, {{0}}, {}), flexarm::InvalidParameter);
  CHECK_THROWS_AS(stepping.advance(start, {{0}, {1e9}}, {}), flexarm::NotConverged);
  CHECK(same_bits(go(stepping, start, 3).state, go(stepping, start, 3).state));
}

}  // namespace flexarm::tests::stepping_test
