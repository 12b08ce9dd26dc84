#include "flexarm/integrators/hht.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "arms.hpp"
#include "flexarm/errors.hpp"
#include "flexarm/simulation/energy.hpp"

namespace flexarm::tests::hht_test {

using flexarm::NotConverged;
using flexarm::integrators::DriveValues;
using flexarm::integrators::HhtCoefficients;
using flexarm::integrators::HhtOptions;
using flexarm::integrators::HhtStepper;

namespace {

const Loads weightless{.gravity = Vector3d::Zero()};

/// Nothing prescribed, no torques; driven coordinates stay.
auto hold(const State& state) {
  const VectorXd zero = VectorXd::Zero(state.s.size());
  return [values = DriveValues{state.s, zero, zero, zero}](double, DriveValues& out) { out = values; };
}

State run(const System& system, State state, double h, int n, double alpha, const Loads& loads) {
  HhtStepper stepper(system, HhtCoefficients::from_alpha(alpha), loads, {.tolerance = 1e-13});
  const auto drives = hold(state);
  for (int k = 0; k < n; ++k) stepper.advance(state, h, drives);
  return state;
}

/// HHT for x'' = −ω² x: the matrix that takes (x, v, v', a) to the next step, straight from (1) to (4).
Eigen::Matrix4d amplification(double omega, double h, double alpha) {
  const auto [al, beta, gamma] = HhtCoefficients::from_alpha(alpha);
  Eigen::Matrix4d left, right;     // left y₁ = right y₀
  left << 1, 0, 0, -beta * h * h,  //
      0, 1, 0, -gamma * h,         //
      omega * omega, 0, 1, 0,      //
      0, 0, -(1 + al), 1;
  right << 1, h, 0, (0.5 - beta) * h * h,  //
      0, 1, 0, (1 - gamma) * h,            //
      0, 0, 0, 0,                          //
      0, 0, -al, 0;
  return left.inverse() * right;
}

double spectral_radius(const Eigen::Matrix4d& A) {
  return Eigen::EigenSolver<Eigen::Matrix4d>(A).eigenvalues().cwiseAbs().maxCoeff();
}

/// A sliding mass on a spring: ω² = k/m.
flexarm::model::Arm oscillator(double m, double k) {
  flexarm::model::Arm arm;
  arm.links = {flexarm::model::RigidLink{"mass", m, Vector3d::Zero(), Matrix3d::Identity()}};
  arm.joints = {{.name = "slide",
                 .type = JointType::prismatic,
                 .child = "mass",
                 .axis = Vector3d::UnitX(),
                 .drive_train = compliant(k)}};
  return arm;
}

/// Released from x = 1 m.
State released(const System& system) {
  State state = system.rigid_state({1.0});
  state.s[system.joints()[0].phi] = 0;
  balance(system, weightless, state);
  return state;
}

}  // namespace

TEST_CASE("Coefficients follow from alpha, alpha from the spectral radius") {
  const auto c = HhtCoefficients::from_alpha(-0.1);
  CHECK(c.beta == near(1.21 / 4));
  CHECK(c.gamma == near(0.6));
  CHECK(HhtCoefficients::from_alpha(0).beta == 0.25);
  struct Row {
    double alpha, rho;
  };
  for (const Row& row : {Row{-0.05, 0.905}, {-0.1, 0.818}, {-0.2, 0.667}, {-0.3, 0.538}, {-1.0 / 3, 0.5}}) {
    CHECK(HhtCoefficients::from_alpha(row.alpha).spectral_radius() == near(row.rho, 1e-3));
    CHECK(HhtCoefficients::from_spectral_radius(row.rho).alpha == near(row.alpha, 1e-2));
  }
  CHECK_THROWS_AS(HhtCoefficients::from_alpha(0.01), flexarm::InvalidParameter);
  CHECK_THROWS_AS(HhtCoefficients::from_alpha(-0.34), flexarm::InvalidParameter);
  CHECK_THROWS_AS(HhtCoefficients::from_alpha(std::nan("")), flexarm::InvalidParameter);
  CHECK_THROWS_AS(HhtCoefficients::from_spectral_radius(0.4), flexarm::InvalidParameter);
}

TEST_CASE("A linear oscillator follows the method's amplification matrix, stiff or soft") {
  for (double alpha : {0.0, -0.05, -0.3}) {
    for (double omega_h : {0.1, 1.0, 30.0, 1000.0}) {
      const double h = 0.01, omega = omega_h / h, m = 2;
      const System system(oscillator(m, m * omega * omega), {{"slide", DriveKind::motor_angle}});
      const State start = released(system);
      const State end = run(system, start, h, 25, alpha, weightless);
      Eigen::Vector4d y(1, 0, -omega * omega, -omega * omega);
      for (int k = 0; k < 25; ++k) y = amplification(omega, h, alpha) * y;
      const int at = system.scalar_offset() + system.joints()[0].theta;
      CAPTURE(alpha);
      CAPTURE(omega_h);
      // The error of a step, 1e-13 m, adds up over 25 steps; accelerations are 1/(β h²) more sensitive.
      CHECK(std::abs(end.s[system.joints()[0].theta] - y[0]) < 1e-10);
      CHECK(std::abs(end.v[at] - y[1]) < 1e-10 * omega);
      CHECK(std::abs(end.v_dot[at] - y[2]) < 1e-9 * omega * omega);
    }
  }
}

TEST_CASE("Its amplitude is lost at the rate that alpha predicts") {
  const double h = 0.01, omega = 40;
  const System system(oscillator(2, 2 * omega * omega), {{"slide", DriveKind::motor_angle}});
  for (double alpha : {0.0, -0.1, -1.0 / 3}) {
    const State end = run(system, released(system), h, 400, alpha, weightless);
    const auto E = flexarm::simulation::energies(system, end, weightless);
    const double amplitude = std::sqrt((E.kinetic + E.elastic) / (omega * omega));
    const double predicted = std::pow(spectral_radius(amplification(omega, h, alpha)), 400);
    CAPTURE(alpha);
    // The energy of one instant sways by ω h about that of the mode; the decay itself is exact.
    CHECK(amplitude == near(predicted, 0.1));
    if (alpha == 0) CHECK(amplitude == near(1, 1e-9));
  }
}

TEST_CASE("The spectral radius at infinite frequency is (1 + α)/(1 − α)") {
  for (double alpha : {-0.05, -0.1, -0.2, -0.3}) {
    const double rho = HhtCoefficients::from_alpha(alpha).spectral_radius();
    // Two eigenvalues meet there, so they are known to the square root of rounding only.
    CHECK(spectral_radius(amplification(1e5, 1, alpha)) == near(rho, 1e-3));
  }
}

TEST_CASE("A rigid pendulum has the exact period of its amplitude, with an error of order two") {
  const double m = 2, c = 0.7, J = 0.1, amplitude = 1.0;
  const System system(pendulum(m, c, J), {{"hinge", DriveKind::free}});
  State start = system.rigid_state({amplitude});
  balance(system, Loads{}, start);
  const double omega = std::sqrt(m * standard_gravity * c / (J + m * c * c));
  const double period = 4 * std::comp_ellint_1(std::sin(amplitude / 2)) / omega;
  // After a quarter of a period the pendulum passes its lowest point.
  const auto angle_at_bottom = [&](int n) {
    return run(system, start, period / 4 / n, n, -0.05, Loads{}).s[0];
  };
  const double e1 = angle_at_bottom(50), e2 = angle_at_bottom(100), e3 = angle_at_bottom(200);
  CHECK(observed_order(e1, e2) == near(2, 0.03));
  CHECK(observed_order(e2, e3) == near(2, 0.03));
  CHECK(std::abs(e3) < 1e-4);
  const State there = run(system, start, period / 400, 400, 0, Loads{});  // and after a whole one it is back
  CHECK(there.s[0] == near(amplitude, 1e-4));
}

TEST_CASE("A spun body about a fixed axis keeps its rate through many turns") {
  const System system(pendulum(2, 0, 0.5), {{"hinge", DriveKind::free}});
  State state = system.rigid_state({0});
  state.v[4] = state.v[6] = 11;
  balance(system, weightless, state);
  const State end = run(system, state, 0.01, 500, -0.05, weightless);
  CHECK(end.s[0] == near(55, 1e-12));  // nearly nine turns, not wrapped
  CHECK(end.v[6] == near(11, 1e-12));
}

TEST_CASE("A flexible arm flung about a free hinge keeps its angular momentum to order two") {
  auto arm = paper_arm({.elements = 2});
  std::get<flexarm::model::BeamLink>(arm.links[0]).material.youngs_modulus = 2e8;  // bends by tens of cm
  const System system(arm, {{"hinge", DriveKind::free}});
  State start = system.rigid_state({0});
  // Turning at 1 rad/s, the tip 30 % faster as if it had been struck: it bends and swings.
  for (int n = 0; n < system.n_nodes(); ++n) {
    const Frame& H = start.frames[n];
    const double faster = n + 1 == system.n_nodes() ? 1.3 : 1;
    start.v.segment<6>(6 * n) << H.R.transpose() * Vector3d(0, 0, -faster * H.x.x()),
        H.R.transpose() * Vector3d::UnitY();
  }
  start.v[system.scalar_offset()] = 1;
  balance(system, weightless, start);
  const auto momentum = [&](const State& state) {
    Vector6d sum = Vector6d::Zero();
    const auto add = [&](int node, const Vector6d& p) {
      sum += flexarm::geometry::adjoint(state.frames[node].inverse()).transpose() * p;
    };
    for (const auto& beam : system.beams()) {
      flexarm::elements::Vector12d v;
      v << state.v.segment<6>(6 * beam.node1()), state.v.segment<6>(6 * beam.node2());
      const flexarm::elements::Vector12d p = beam.mass() * v;
      add(beam.node1(), p.head<6>());
      add(beam.node2(), p.tail<6>());
    }
    for (const auto& body : system.bodies())
      add(body.node(), body.mass() * state.v.segment<6>(6 * body.node()));
    return sum[4];  // about the hinge
  };
  const double before = momentum(start);
  const auto drift = [&](int n) {
    return std::abs(momentum(run(system, start, 1.0 / n, n, -0.05, weightless)) / before - 1);
  };
  const double e1 = drift(400), e2 = drift(800);
  CHECK(e1 < 1e-4);
  CHECK(e2 < e1 / 3);
}

TEST_CASE("A step that fails is halved until it succeeds, and ends where small steps end") {
  auto arm = paper_arm({.elements = 2, .hub_stiffness = 1e5});
  const System system(arm, {{"hinge", DriveKind::motor_angle}});
  const State start = system.rigid_state({0});
  const auto& at = system.joints()[0];
  const auto turning = [&](double t, DriveValues& values) {  // a quarter turn within 0.2 s
    const double x = std::min(t / 0.2, 1.0);
    values.s[at.phi] = half_pi * x * x * (3 - 2 * x);
    values.v[at.phi] = half_pi * 6 * x * (1 - x) / 0.2;
    values.v_dot[at.phi] = half_pi * 6 * (1 - 2 * x) / 0.04;
  };
  State large = start, small = start;
  HhtStepper bold(system, HhtCoefficients::from_alpha(-0.1), Loads{}, {.max_iterations = 4});
  bold.advance(large, 0.1, turning);
  CHECK(bold.statistics().halvings > 0);
  CHECK(bold.statistics().steps > 1);
  CHECK(large.t == near(0.1));
  HhtStepper careful(system, HhtCoefficients::from_alpha(-0.1), Loads{});
  for (int k = 0; k < 200; ++k) careful.advance(small, 0.1 / 200, turning);
  CHECK(error(system.point_frame(large, 0).x, system.point_frame(small, 0).x) < 0.05);
}

TEST_CASE("A step that cannot be made leaves the state untouched and says when and how far it got") {
  const System system(paper_arm({.elements = 2, .hub_stiffness = 1e5}), {{"hinge", DriveKind::motor_angle}});
  State state = system.rigid_state({0.2});
  state.t = 3;
  const State before = state;
  HhtStepper stepper(system, HhtCoefficients::from_alpha(-0.1), Loads{},
                     {.tolerance = 1e-30, .max_iterations = 2, .max_halvings = 3});
  try {
    stepper.advance(state, 0.01, hold(state));
    FAIL("two iterations reached 1e-30");
  } catch (const NotConverged& failure) {
    CHECK(failure.time > 3);
    CHECK(failure.time <= 3.01);
    CHECK(failure.iteration == 2);
    CHECK(std::isfinite(failure.residual));
    CHECK(std::string(failure.what()).find("t = 3.0") == 0);
  }
  CHECK(state.t == before.t);
  CHECK(error(state.v, before.v) == 0);
  CHECK(error(state.v_dot, before.v_dot) == 0);
  CHECK(error(state.s, before.s) == 0);
  CHECK(error(state.multipliers, before.multipliers) == 0);
  for (std::size_t n = 0; n < state.frames.size(); ++n)
    CHECK(error(state.frames[n].x, before.frames[n].x) == 0);
}

TEST_CASE("One factorisation serves a rigid rotation through a half turn") {
  const System system(paper_arm({.hub_stiffness = 1e5}), {{"hinge", DriveKind::link_angle}});
  State state = system.rigid_state({0});
  const int phi = system.joints()[0].phi;
  HhtStepper stepper(system, HhtCoefficients::from_alpha(-0.1), weightless);
  const auto slowly = [&](double t, DriveValues& values) {
    values.s[phi] = 0.2 * t * t;
    values.v[phi] = 0.4 * t;
    values.v_dot[phi] = 0.4;
  };
  for (int k = 0; k < 800; ++k) stepper.advance(state, 5e-3, slowly);
  CHECK(state.s[phi] == near(3.2));
  CHECK(stepper.statistics().factorisations <= 3);
  CHECK(stepper.statistics().iterations <= 4 * stepper.statistics().steps);
}

TEST_CASE("A step below a nanosecond, or none at all, is refused") {
  flexarm::integrators::check_step(1e-9);
  for (const double h : {0.0, -1e-3, 1e-10, 1e-76, std::nan(""), HUGE_VAL}) {
    CAPTURE(h);
    CHECK_THROWS_AS(flexarm::integrators::check_step(h), flexarm::InvalidParameter);
  }
}

TEST_CASE("A matrix that is not finite ends the step with its time and the residual of the state") {
  const System system(paper_arm(), {{"hinge", DriveKind::motor_angle}});
  const State start = system.rigid_state({0.3});
  State state = start;
  HhtStepper stepper(system, HhtCoefficients::from_alpha(-0.05), {});
  VectorXd r(system.n_velocities());
  system.residual(start, {}, true, r);
  try {
    stepper.advance(state, 1e-160, hold(start));  // 1/(β h²) overflows
    FAIL("the step must fail");
  } catch (const NotConverged& failure) {
    CHECK(std::string(failure.what()).find("singular or not finite") != std::string::npos);
    CHECK(failure.time > 0);
    CHECK(failure.iteration == 0);
    CHECK(failure.residual == near(r.head(system.n_free()).cwiseAbs().maxCoeff()));
  }
  CHECK(state.t == start.t);
}

}  // namespace flexarm::tests::hht_test
