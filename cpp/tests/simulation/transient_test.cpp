#include "flexarm/simulation/transient.hpp"

#include <doctest/doctest.h>

#include <numbers>

#include "arms.hpp"
#include "flexarm/errors.hpp"
#include "flexarm/simulation/modal.hpp"

namespace flexarm::tests::transient_test {

using namespace flexarm::simulation;
using flexarm::InvalidParameter;
using flexarm::integrators::DriveValues;
using flexarm::integrators::HhtCoefficients;
using flexarm::integrators::HhtStepper;
using std::numbers::pi;

namespace {

const Loads weightless{.gravity = Vector3d::Zero()};

/// 10 x³ − 15 x⁴ + 6 x⁵ with its derivatives, from 0 to 1 and there held.
PiecewisePolynomial smooth_step(double from, double to, double duration) {
  const double a = to - from, T = duration;
  MatrixXd c(6, 1);
  c << 6 * a / std::pow(T, 5), -15 * a / std::pow(T, 4), 10 * a / std::pow(T, 3), 0, 0, from;
  return {{0, T}, c};
}

/// Total energy that the motion has gained against what came in and went out.
double energy_gap(const Transient& run) {
  const Eigen::Index last = run.time.size() - 1;
  const VectorXd total = run.kinetic + run.elastic + run.gravity;
  return total[last] - total[0] - run.work[last] + run.damped[last];
}

}  // namespace

TEST_CASE("Swing of the paper's arm: the reference values, with an error of order two in the step") {
  const System system(paper_arm({.elements = 4, .hub_stiffness = 1e5}), {{"hinge", DriveKind::motor_angle}});
  const auto rest = static_equilibrium(system, {half_pi}, Loads{});
  const int phi = system.joints()[0].phi;
  const double w = 2 * pi * 0.05;
  // q = 1.2 sin(w t) s(t/4) with the smooth step s.
  const PiecewisePolynomial fade = smooth_step(0, 1, 4);
  const auto swing = [&](double t, DriveValues& values) {
    const auto [s, s1, s2] = fade(t);
    const double sine = 1.2 * std::sin(w * t), cosine = 1.2 * w * std::cos(w * t);
    values.s[phi] = half_pi + sine * s;
    values.v[phi] = cosine * s + sine * s1;
    values.v_dot[phi] = -w * w * sine * s + 2 * cosine * s1 + sine * s2;
  };
  /// Tangential offset from the rigid arm [mm] at 2 s and 5 s.
  const auto offsets = [&](double h) {
    State state = rest.state;
    HhtStepper stepper(system, HhtCoefficients::from_alpha(-0.05), rest.loads);
    std::array<double, 2> offset{};
    for (int k = 1; k <= std::lround(5 / h); ++k) {
      stepper.advance(state, h, swing);
      const double q = state.s[phi] - half_pi;
      const double tangential = system.point_frame(state, 0).x.dot(Vector3d(-std::cos(q), 0, std::sin(q)));
      if (k == std::lround(2 / h)) offset[0] = 1e3 * tangential;
      if (k == std::lround(5 / h)) offset[1] = 1e3 * tangential;
    }
    return offset;
  };
  const auto coarse = offsets(8e-3), middle = offsets(4e-3), fine = offsets(2e-3);
  const std::array<double, 2> reference = {-21.45680, -47.96946};  // Euler-Bernoulli, at 2 s and 5 s
  for (std::size_t k = 0; k < 2; ++k) {
    CAPTURE(k);
    // Self-convergence; what four elements leave, 1e-3 mm, drops out. At the turn, 5 s, higher orders show.
    CHECK(observed_order(coarse[k] - middle[k], middle[k] - fine[k]) == near(2, 0.08));
    CHECK(std::abs(fine[k] - reference[k]) < 1900 * 4e-6 + 1e-3);
  }
}

TEST_CASE("Spin-up manoeuvre of Simo and Vu-Quoc: lag on the way, steady extension L (tan k/k − 1)") {
  flexarm::model::Arm arm;
  // EA = 2.8e7, GA = 1e7, EI = 1.4e4, ρA = 1.2, ρI = 6e-4.
  const flexarm::model::Section section{1, 5e-4, 5e-4, 1e-3, 1, 1};
  arm.links = {flexarm::model::BeamLink{.name = "blade",
                                        .end = {10, 0, 0},
                                        .section = section,
                                        .material = {2.8e7, 1e7, 1.2},
                                        .elements = 8,
                                        .damping_ratio = 0}};
  arm.joints = {{.name = "hub", .child = "blade", .axis = Vector3d::UnitZ()}};
  arm.points = {{.name = "tip", .link = "blade", .position = {10, 0, 0}}};
  const System system(arm, {{"hub", DriveKind::motor_angle}});
  const auto spin = [&](double t, DriveValues& values) {
    const double b = 15 / (2 * pi), c = 6.0 / 15;
    const bool turning = t < 15;
    values.s[0] = turning ? c * (t * t / 2 + b * b * (std::cos(t / b) - 1)) : 6 * t - 45;
    values.v[0] = turning ? c * (t - b * std::sin(t / b)) : 6;
    values.v_dot[0] = turning ? c * (1 - std::cos(t / b)) : 0;
  };
  State state = system.rigid_state({0});
  HhtStepper stepper(system, HhtCoefficients::from_alpha(-0.05), weightless);
  double lag = 0, when = 0, extension = 0, samples = 0;
  const double h = 0.01;
  for (int k = 1; k <= 2500; ++k) {
    stepper.advance(state, h, spin);
    const Vector3d tip = flexarm::geometry::exp3({0, 0, -state.s[0]}) * system.point_frame(state, 0).x;
    if (tip.y() < lag) lag = tip.y(), when = state.t;
    // Bending that is left, y up to some tenths of a millimetre, shortens by less than y²/L = 1e-8.
    if (state.t > 20) extension += tip.x() - 10, ++samples;
  }
  const double k = 6 * 10 * std::sqrt(1.2 / 2.8e7);
  const double exact = 10 * (std::tan(k) / k - 1);
  CHECK(exact == near(5.14317e-4, 1e-5));
  CHECK(extension / samples == near(exact, 1e-4));
  CHECK(lag == near(-0.5738, 2e-3));
  CHECK(when == near(6.76, 5e-3));
}

TEST_CASE("Energy in is energy stored and lost, with an error of order two") {
  auto arm = two_link_arm();
  arm.joints[1].drive_train.bearing = {flexarm::joints::DahlFriction{0.5, 0.05},
                                       flexarm::joints::ViscousFriction{0.2}};
  const System system(arm, {{"shoulder", DriveKind::motor_angle}, {"elbow", DriveKind::motor_angle}});
  const auto rest = static_equilibrium(system, {0.4, -0.3}, Loads{});
  const std::vector<PiecewisePolynomial> drives = {smooth_step(0.4, -0.5, 0.8), smooth_step(-0.3, 0.9, 0.6)};
  const auto run = [&](double h) {
    return simulate(system, rest, drives,
                    {.end = 1, .step = h, .alpha = -0.02, .tolerance = 1e-12, .record_energies = true});
  };
  const Transient coarse = run(2e-3), fine = run(1e-3);
  const Eigen::Index last = fine.time.size() - 1;
  CHECK(fine.damped[last] > 0.1);
  CHECK(std::abs(fine.work[last]) > 1);
  CHECK(std::abs(energy_gap(fine)) < 1e-4 * fine.kinetic.maxCoeff());
  CHECK(std::abs(energy_gap(fine)) < std::abs(energy_gap(coarse)) / 3);
  // What friction takes grows, but for the little that it gives back at a reversal: T_c w at most.
  double most = 0;
  for (double damped : fine.damped) {
    most = std::max(most, damped);
    CHECK(most - damped < 0.5 * 0.05);
  }
}

TEST_CASE("A plucked arm decays at its damping ratio") {
  const System system(paper_arm({.elements = 2, .damping_ratio = 0.02}), {{"hinge", DriveKind::motor_angle}});
  Loads pulled = weightless;
  pulled.points = {{.point = 0, .force = {0, 0, 1}}};
  auto start = static_equilibrium(system, {0}, pulled);
  const Modes found = modes(system, static_equilibrium(system, {0}, weightless), 1);
  start.loads = weightless;
  const auto run =
      simulate(system, start, {PiecewisePolynomial::constant(0)}, {.end = 5, .step = 2e-3, .alpha = 0});
  const double omega = 2 * pi * found.frequency_hz[0];
  // Amplitude from displacement and velocity at the end; higher modes are long gone.
  const Eigen::Index last = run.time.size() - 1;
  const double x0 = run.position(2, 0), x = run.position(2, last), v = run.velocity(2, last);
  CHECK(std::hypot(x, v / omega) / x0 == near(std::exp(-found.damping_ratio[0] * omega * 5), 0.03));
}

TEST_CASE("Recorded velocities are the rates of recorded positions, torques those that the motion needs") {
  const double m = 2, c = 0.7, J = 0.1;
  const System system(pendulum(m, c, J), {{"hinge", DriveKind::motor_angle}});
  const auto rest = static_equilibrium(system, {0.2}, Loads{});
  const PiecewisePolynomial drive = smooth_step(0.2, 1.5, 1);
  const auto run = simulate(system, rest, {drive},
                            {.end = 0.9, .step = 1e-3, .record_rotations = true, .record_forces = true});
  CHECK(run.time.size() == 901);
  CHECK(run.position.rows() == 3);
  CHECK(run.base_wrench.cols() == 901);
  for (Eigen::Index k : {200, 500, 800}) {
    const auto [q, q1, q2] = drive(run.time[k]);
    const VectorXd rate = (run.position.col(k + 1) - run.position.col(k - 1)) / 2e-3;
    CHECK(error(run.velocity.col(k), rate) < 1e-4);  // h² x'''/6
    CHECK(run.joint_angle(0, k) == near(q, 1e-12));
    CHECK(run.angular_rate(1, k) == near(q1, 1e-5));  // h² q'''/12
    // A driven joint follows exactly, so its torque is that of the rigid pendulum up to the stepping of v'.
    const double torque = (J + m * c * c) * q2 + m * standard_gravity * c * std::sin(q);
    CHECK(run.joint_torque(0, k) == near(torque, 1e-3));
    CHECK(run.motor_torque(0, k) == near(run.joint_torque(0, k), 1e-9));
    CHECK(run.orientation.col(k).norm() == near(1, 1e-14));
    CHECK(2 * std::atan2(run.orientation(1, k), run.orientation(3, k)) == near(q, 1e-12));
  }
}

TEST_CASE("An arm at rest stays at rest") {
  const System system(two_link_arm(), {{"shoulder", DriveKind::locked}, {"elbow", DriveKind::motor_angle}});
  const auto rest = static_equilibrium(system, {0.4, -0.3}, Loads{});
  const auto run =
      simulate(system, rest, {{}, PiecewisePolynomial::constant(-0.3)}, {.end = 0.5, .step = 5e-3});
  CHECK(largest(run.position.colwise() - run.position.col(0)) < 1e-9);
}

TEST_CASE("The motion turns with arm, base and gravity") {
  Random random(7);
  const Frame Q = flexarm::geometry::exp6(random.twist(1, 2));
  const auto tip = [](const flexarm::model::Arm& arm, const Vector3d& gravity) {
    const System system(
        arm, {{"turn", DriveKind::motor_angle}, {"slide", DriveKind::free}, {"lift", DriveKind::locked}});
    // The slide is held by its own springs once its motor is; free, it glides down.
    const Equilibrium start{.state = system.rigid_state({0.1, 0.05, 0.2}), .loads = {.gravity = gravity}};
    const auto run =
        simulate(system, start, {smooth_step(0.1, 0.6, 0.3), {}, {}}, {.end = 0.3, .step = 5e-3});
    return Vector3d(run.position.col(run.position.cols() - 1).head<3>());
  };
  auto turned = spatial_arm();
  turned.joints[0].origin = Q * turned.joints[0].origin;
  const Vector3d g(0, 0, -9.81);
  CHECK(error(tip(turned, Q.R * g), Q * tip(spatial_arm(), g)) < 1e-8);
}

TEST_CASE("Whoever watches a run is told how far it is, and may end it") {
  const System system(pendulum(2, 0.7, 0.1), {{"hinge", DriveKind::free}});
  const Equilibrium start{.state = system.rigid_state({0}), .loads = Loads{}};
  const std::vector<PiecewisePolynomial> none(1);
  double seen = -1;
  const auto watch = [&](double done) {
    CHECK(done > seen);
    CHECK(done <= 1);
    seen = done;
    return false;
  };
  const auto run =
      simulate(system, start, none, {.end = 1e4, .step = 1e-3}, watch);  // hours, if nobody ends it
  CHECK(run.cancelled);
  CHECK(seen > 0);
  CHECK(run.time.size() < 9'000'000);
  CHECK(run.position.cols() == run.time.size());
  CHECK(run.joint_angle.cols() == run.time.size());
  CHECK(run.time[run.time.size() - 1] == near(seen * 1e4));
}

TEST_CASE("Instants are start + k step without drift, the last one not before the end") {
  const System system(pendulum(2, 0.7, 0.1), {{"hinge", DriveKind::locked}});
  const auto rest = static_equilibrium(system, {0.2}, Loads{});
  const auto run = simulate(system, rest, {{}}, {.start = 2, .end = 2.35, .step = 0.1});
  REQUIRE(run.time.size() == 5);
  for (Eigen::Index k = 0; k < 5; ++k) CHECK(run.time[k] == near(2 + 0.1 * static_cast<double>(k), 1e-15));
  CHECK(simulate(system, rest, {{}}, {.end = 0.3, .step = 0.1}).time.size() == 4);  // 0.3/0.1 is not quite 3
}

TEST_CASE("Impossible options are refused with their values") {
  const System system(pendulum(2, 0.7, 0.1), {{"hinge", DriveKind::locked}});
  const auto rest = static_equilibrium(system, {0.2}, Loads{});
  CHECK_THROWS_WITH_AS(simulate(system, rest, {{}}, {.step = 0}),
                       "step must be positive, at least 1e-09 s and finite, got 0 s", InvalidParameter);
  CHECK_THROWS_WITH_AS(simulate(system, rest, {{}}, {.start = 1, .end = 1}),
                       doctest::Contains("must lie after its start"), InvalidParameter);
  CHECK_THROWS_WITH_AS(simulate(system, rest, {}, {}),
                       doctest::Contains("one drive for each of the 1 joints"), InvalidParameter);
  CHECK_THROWS_WITH_AS(simulate(system, rest, {{}}, {.alpha = 0.2}), doctest::Contains("[-1/3, 0]"),
                       InvalidParameter);
}

}  // namespace flexarm::tests::transient_test
