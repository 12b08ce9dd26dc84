#include "flexarm/simulation/sampled_run.hpp"

#include <doctest/doctest.h>

#include "arms.hpp"
#include "flexarm/errors.hpp"
#include "flexarm/simulation/transient.hpp"

namespace flexarm::tests::sampled_run_test {

using namespace flexarm::simulation;

namespace {

System driven_by_torque() {
  auto arm = paper_arm({.elements = 2, .hub_stiffness = 1e5, .damping_ratio = 0.01});
  arm.joints[0].drive_train.gear_ratio = 120;
  arm.joints[0].drive_train.rotor_inertia = 1e-3;
  return {arm, {{"hinge", DriveKind::torque}}};
}

}  // namespace

TEST_CASE("A torque held from sample to sample moves the arm as the same torque of a whole run does") {
  const System system = driven_by_torque();
  const auto rest = static_equilibrium(system, {half_pi}, Loads{});
  SampledRun sampled(system, rest, {{}}, {.end = 0.2, .step = 1e-3});
  const VectorXd torque = VectorXd::Constant(1, 150.0);
  for (int k = 0; k < 50; ++k) sampled.advance(torque, 4);
  const auto run = simulate(system, rest, {PiecewisePolynomial::constant(150)}, {.end = 0.2, .step = 1e-3});
  const Eigen::Index last = run.time.size() - 1;
  CHECK(sampled.time() == near(0.2));
  CHECK(error(sampled.point_position(0), run.position.col(last)) < 1e-9);
  CHECK(error(sampled.point_velocity(0), run.velocity.col(last)) < 1e-7);
  CHECK(sampled.drive_angles()[0] == near(run.drive_angle(0, last), 1e-9));
  CHECK(sampled.joint_angles()[0] == near(run.joint_angle(0, last), 1e-9));
  CHECK(sampled.drive_rates()[0] == near(run.drive_rate(0, last), 1e-6));
  CHECK(sampled.joint_rates()[0] == near(run.joint_rate(0, last), 1e-6));
  CHECK(sampled.statistics().steps == 200);
  CHECK(sampled.done());
  const Transient recorded = sampled.result();
  CHECK(recorded.time.size() == run.time.size());
  CHECK(error(recorded.position, run.position) < 1e-9);
}

TEST_CASE("What was recorded so far can be looked at while the run goes on, which ends where it was told") {
  const System system = driven_by_torque();
  const auto rest = static_equilibrium(system, {half_pi}, Loads{});
  SampledRun run(system, rest, {{}}, {.end = 0.05, .step = 1e-3});
  run.advance(VectorXd::Zero(1), 10);
  CHECK(run.result().time.size() == 11);
  CHECK_FALSE(run.done());
  run.advance(VectorXd::Zero(1), 100);
  CHECK(run.done());
  CHECK(run.time() == near(0.05));
  CHECK(run.result().position.cols() == 51);
}

TEST_CASE("Let go, a held arm starts from where it was held") {
  auto arm = two_link_arm();
  const System held(arm, {{"shoulder", DriveKind::motor_angle}, {"elbow", DriveKind::link_angle}});
  const System loose(arm, {{"shoulder", DriveKind::torque}, {"elbow", DriveKind::link_angle}});
  const auto rest = static_equilibrium(held, {0.4, -0.3}, Loads{});
  const auto start = released(held, rest, loose);
  const auto angles = [](const System& system, const State& state, std::size_t j) {
    return std::pair(state.s[system.joints()[j].phi], state.s[system.joints()[j].theta]);
  };
  for (std::size_t j : {0, 1}) CHECK(angles(loose, start.state, j) == angles(held, rest.state, j));
  // Its own weight, no longer held, is all that is left over: the motor's torque.
  VectorXd r(loose.n_velocities());
  loose.residual(start.state, start.loads, false, r);
  const int phi = loose.joints()[0].phi;
  CHECK(std::abs(r[loose.scalar_offset() + phi]) > 10);
  r[loose.scalar_offset() + phi] = 0;
  CHECK(largest(r.head(loose.n_free())) < 1e-6);
}

TEST_CASE("A proportional controller with damping brings the arm to its command") {
  const System system = driven_by_torque();
  const auto rest = static_equilibrium(system, {half_pi}, Loads{});
  SampledRun run(system, rest, {{}}, {.end = 4, .step = 2e-3, .alpha = -0.1});
  const double command = half_pi + 0.2;
  for (int k = 0; k < 2000; ++k) {
    const double torque = 4000 * (command - run.drive_angles()[0]) - 1200 * run.drive_rates()[0];
    run.advance(VectorXd::Constant(1, torque), 1);
  }
  // What is left is the weight's moment over the controller's stiffness: k (q_c − q) = moment.
  const double q = run.drive_angles()[0];
  const double lever = 14.1 * 3 + 5.82e-4 * 7850 * 3 * 1.5;
  CHECK(4000 * (command - q) == near(lever * standard_gravity * std::sin(q - half_pi), 0.02));
  CHECK(std::abs(run.drive_rates()[0]) < 1e-3);
}

TEST_CASE("A wrong number of torques and an impossible step are refused") {
  const System system = driven_by_torque();
  const auto rest = static_equilibrium(system, {half_pi}, Loads{});
  CHECK_THROWS_AS(SampledRun(system, rest, {{}}, {.step = 0}), flexarm::InvalidParameter);
  SampledRun run(system, rest, {{}}, {.end = 1, .step = 1e-3});
  CHECK_THROWS_WITH_AS(run.advance(VectorXd::Zero(2), 1),
                       doctest::Contains("one motor torque for each of the 1 joints"),
                       flexarm::InvalidParameter);
}

}  // namespace flexarm::tests::sampled_run_test
