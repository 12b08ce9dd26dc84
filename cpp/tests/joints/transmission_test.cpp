#include "flexarm/joints/transmission.hpp"

#include <doctest/doctest.h>

#include "arms.hpp"
#include "flexarm/errors.hpp"
#include "flexarm/simulation/reactions.hpp"
#include "flexarm/simulation/sampled_run.hpp"
#include "flexarm/simulation/statics.hpp"

namespace flexarm::tests::transmission_test {

using namespace flexarm::simulation;
using flexarm::InvalidParameter;
using flexarm::joints::Transmission;

namespace {

// Twice a motor turn at a ratio of 120, of 0.1 mrad: ψ' swings by 2.4 %.
const Transmission ripple{.scale = 1.002, .amplitude = 1e-4, .multiple = 2, .phase = 0.7};

flexarm::model::Arm rippling(bool rigid) {
  auto arm = paper_arm({.elements = 2, .hub_stiffness = rigid ? 0.0 : 1e5, .damping_ratio = 0.02});
  arm.joints[0].drive_train.gear_ratio = 120;
  arm.joints[0].drive_train.rotor_inertia = 1e-3;
  arm.joints[0].drive_train.transmission = ripple;
  return arm;
}

}  // namespace

TEST_CASE("ψ', ψ'' are the derivatives of ψ, and the inverse undoes it") {
  for (const Transmission& t : {ripple.geared(120), Transmission{}, Transmission{-0.7, 0.02, 30, 1}}) {
    for (double phi : {-1.3, 0.0, 0.01, 2.5}) {
      const auto at = t(phi);
      const double ripples = std::max(t.multiple, 1.0);
      CHECK(std::abs(derivative([&](double x) { return t(x).psi; }, phi, 3e-3 / ripples) - at.first) < 2e-10);
      CHECK(std::abs(derivative([&](double x) { return t(x).first; }, phi, 1e-3 / ripples) - at.second) <
            1e-9 * std::max(1.0, t.multiple));
      CHECK(std::abs(t.inverse(at.psi) - phi) < 1e-14);
    }
  }
}

TEST_CASE("At rest the link stands at ψ of the motor, less what its torque deflects the spring") {
  for (bool rigid : {true, false}) {
    const System system(rippling(rigid), {{"hinge", DriveKind::motor_angle}});
    const auto rest = static_equilibrium(system, {0.4}, Loads{});
    const auto& at = system.joints()[0];
    const double torque = joint_torque(system, rest.state, 0);
    const double psi = 0.4 / 1.002 + 1e-4 * std::sin(2 * 120 * 0.4 + 0.7);
    CHECK(rest.state.s[at.theta] == near(psi - (rigid ? 0 : torque / 1e5), 1e-10));
    CHECK(rest.state.s[at.phi] == 0.4);
  }
}

TEST_CASE("The motor gives the torque that virtual work asks: T ψ'(φ)") {
  for (DriveKind kind : {DriveKind::motor_angle, DriveKind::link_angle}) {
    const System system(rippling(false), {{"hinge", kind}});
    const auto rest = static_equilibrium(system, {0.4}, Loads{});
    const double phi = rest.state.s[system.joints()[0].phi];
    const double slope = ripple.geared(120)(phi).first;
    CHECK(motor_torques(system, rest.state, false)[0] ==
          near(joint_torque(system, rest.state, 0) * slope, 1e-9));
    if (kind == DriveKind::link_angle) CHECK(rest.state.s[system.joints()[0].theta] == near(0.4));
  }
}

TEST_CASE("Driven at its output, a motor follows ψ⁻¹ and its derivatives") {
  const System system(rippling(false), {{"hinge", DriveKind::link_angle}});
  const State state = system.rigid_state({0.2});
  const MatrixXd cubic = (MatrixXd(4, 1) << -0.3, 0.4, 0.5, 0.2).finished();
  const auto drive = drives_of_joints(system, state, {PiecewisePolynomial({0, 2}, cubic)});
  const int phi = system.joints()[0].phi;
  const auto at = [&](double t) {
    flexarm::integrators::DriveValues values;
    values.s = values.v = values.v_dot = values.torques = VectorXd::Zero(system.n_scalars());
    drive(t, values);
    return Vector3d(values.s[phi], values.v[phi], values.v_dot[phi]);
  };
  const double t = 0.31, theta = 0.2 + t * (0.5 + t * (0.4 - 0.3 * t));
  CHECK(ripple.geared(120)(at(t)[0]).psi == near(theta));
  CHECK(at(t)[1] == near(derivative([&](double x) { return at(x)[0]; }, t, 1e-4), 1e-9));
  CHECK(at(t)[2] == near(derivative([&](double x) { return at(x)[1]; }, t, 1e-4), 1e-9));
}

TEST_CASE("A motor let go turns as one whose angle is prescribed along the same motion") {
  // The torque that a run with prescribed angle needs, given back to a free motor, moves it the same way.
  for (bool rigid : {true, false}) {
    const System told(rippling(rigid), {{"hinge", DriveKind::motor_angle}});
    const System let(rippling(rigid), {{"hinge", DriveKind::torque}});
    const auto rest = static_equilibrium(told, {half_pi}, Loads{});
    const double h = 1e-3;
    const int n = 400;
    MatrixXd quintic(6, 1);  // 0.3 rad by 10 x³ − 15 x⁴ + 6 x⁵, x = t/0.4
    quintic << 0.3 * 6 / std::pow(0.4, 5), -0.3 * 15 / std::pow(0.4, 4), 0.3 * 10 / std::pow(0.4, 3), 0, 0,
        half_pi;
    const auto prescribed =
        simulate(told, rest, {PiecewisePolynomial({0, 0.4}, quintic)}, {.end = n * h, .step = h});
    SampledRun free(let, released(told, rest, let), {{}}, {.end = n * h, .step = h});
    for (int k = 1; k <= n; ++k) free.advance(prescribed.motor_torque.col(k), 1);
    // The torque at the end of the first step holds from its start: 0.45 h² of the jerk, over the run.
    CHECK(free.drive_angles()[0] == near(prescribed.drive_angle(0, n), 1e-5));
    CHECK(error(free.point_position(0), prescribed.position.col(n)) < 1e-5);
  }
}

TEST_CASE("An ideal transmission changes nothing") {
  auto arm = rippling(false);
  arm.joints[0].drive_train.transmission = Transmission{};
  const System with(arm, {{"hinge", DriveKind::torque}});
  arm.joints[0].drive_train.transmission.reset();
  const System without(arm, {{"hinge", DriveKind::torque}});
  CHECK(with.n_unknowns() == without.n_unknowns() + 2);
  const std::vector<PiecewisePolynomial> pull{PiecewisePolynomial::constant(150)};
  const auto tip = [&](const System& system) {
    const auto rest = static_equilibrium(system, {half_pi}, Loads{});
    return MatrixXd(simulate(system, rest, pull, {.end = 0.3, .step = 2e-3}).position);
  };
  CHECK(error(tip(with), tip(without)) < 1e-8);
}

TEST_CASE("At the output of a gear the error counts turns of the shaft that drives it") {
  flexarm::model::Arm arm = two_link_arm();
  arm.joints[1].drive_train.transmission = Transmission{.amplitude = 1e-3, .multiple = 3};
  arm.gears = {{"coupling", "shoulder", "elbow", 7}};
  const System system(arm, {{"shoulder", DriveKind::motor_angle}, {"elbow", DriveKind::free}});
  CHECK(system.transmission(1)->multiple == 21);
  CHECK(system.transmission(0) == nullptr);
}

TEST_CASE("A train that would turn back is refused with the name of its joint") {
  auto arm = rippling(true);
  arm.joints[0].drive_train.transmission->amplitude = 5e-3;
  CHECK_THROWS_WITH_AS(System(arm, {}), doctest::Contains("joint 'hinge': transmission error: an amplitude"),
                       InvalidParameter);
  arm.joints[0].drive_train.transmission = Transmission{.scale = 0};
  CHECK_THROWS_WITH_AS(System(arm, {}), doctest::Contains("scale of a gear ratio must not be zero"),
                       InvalidParameter);
}

}  // namespace flexarm::tests::transmission_test
