#include "flexarm/simulation/modal.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>

#include "arms.hpp"

namespace flexarm::tests::modal_test {

using flexarm::simulation::Modes;
using flexarm::simulation::modes;
using flexarm::simulation::static_equilibrium;

namespace {

const Loads weightless{.gravity = Vector3d::Zero()};

Modes modes_of(const flexarm::model::Arm& arm, double angle, const Loads& loads, int count,
               DriveKind drive = DriveKind::motor_angle) {
  const System system(arm, {{"hinge", drive}});
  return modes(system, static_equilibrium(system, {angle}, loads), count);
}

/// First frequency of the paper's arm under the tension of its own weight, clamped, by Ritz's method on
/// (EI w'')'' − (N w')' = ω² ρA w  with  N = g (M + ρA (L − x))  and  w = Σ a_i ξ^(i + 2).
double with_tension(double g) {
  constexpr double EI = 210e9 * 2.37e-7, rho_A = 7850 * 5.82e-4, L = 3, mass = 14.1;
  constexpr int n = 7;
  MatrixXd K(n, n), M(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double p = i + 2, q = j + 2;
      const double curvatures = p * (p - 1) * q * (q - 1) / (p + q - 3);
      const double at_tip = 1 / (p + q - 1), along = at_tip - 1 / (p + q);  // ∫ w' w' and ∫ (1 − ξ) w' w'
      K(i, j) = EI / (L * L * L) * curvatures + g / L * p * q * (mass * at_tip + rho_A * L * along);
      M(i, j) = rho_A * L / (p + q + 1) + mass;
    }
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> ritz(K, M, Eigen::EigenvaluesOnly);
  return std::sqrt(ritz.eigenvalues()[0]) / (2 * std::numbers::pi);
}

}  // namespace

TEST_CASE("Frequencies of the paper's arm are the roots of the exact frequency equation") {
  struct Row {
    double hub_stiffness, f1, f2, f3;
  };
  // In space every frequency comes twice; a hub spring acts in one plane only.
  for (const Row& row : {Row{0, 2.84155, 29.9552, 93.8947}, Row{1e5, 2.29633, 24.9427, 81.7074}}) {
    const Modes found =
        modes_of(paper_arm({.elements = 20, .hub_stiffness = row.hub_stiffness}), 0, weightless, 7);
    for (double f : {row.f1, row.f2, row.f3}) {
      double nearest = 1e9;
      for (double g : found.frequency_hz) nearest = std::min(nearest, std::abs(g - f));
      CAPTURE(f);
      CHECK(nearest < 2e-5 * f);  // twenty elements; the reference has six digits
    }
  }
}

TEST_CASE("Gravity stiffens the hanging arm and softens the upright one") {
  for (double sign : {1.0, -1.0}) {
    const double found = modes_of(paper_arm({.elements = 16}), sign * half_pi, Loads{}, 1).frequency_hz[0];
    CHECK(found == near(with_tension(sign * standard_gravity), 2e-6));
    CHECK(found == near(2.84155 * (1 + sign * 0.0065), 1e-4));  // by 0.65 %
  }
}

TEST_CASE("A link's damping ratio is that of its first clamped mode") {
  auto arm = paper_arm({.elements = 4, .damping_ratio = 0.013});
  arm.payloads.clear();  // the link alone
  const Modes found = modes_of(arm, 0, weightless, 2);
  CHECK(found.damping_ratio[0] == near(0.013, 1e-6));
  CHECK(found.damped_frequency_hz[0] == near(found.frequency_hz[0] * std::sqrt(1 - 0.013 * 0.013), 1e-6));
}

TEST_CASE("A free pendulum swings at √(m g c/(J + m c²))") {
  const Modes found = modes_of(pendulum(2, 0.7, 0.1), 0, Loads{}, 3, DriveKind::free);
  REQUIRE(found.frequency_hz.size() == 1);
  CHECK(2 * std::numbers::pi * found.frequency_hz[0] ==
        near(std::sqrt(2 * standard_gravity * 0.7 / (0.1 + 2 * 0.49)), 1e-9));
}

TEST_CASE("A rotor behind a spring and a damper is the oscillator of the textbook") {
  auto arm = pendulum(2, 0, 0.5);  // balanced: gravity does not matter
  arm.joints[0].drive_train = compliant(300, 2.4);
  const Modes found = modes_of(arm, 0, weightless, 1);
  const double omega = std::sqrt(300 / 0.5);
  CHECK(2 * std::numbers::pi * found.frequency_hz[0] == near(omega, 1e-9));
  CHECK(found.damping_ratio[0] == near(2.4 / (2 * 0.5 * omega), 1e-9));
}

TEST_CASE("A free rotor and its load vibrate against one another") {
  auto arm = pendulum(2, 0, 0.5);
  arm.joints[0].drive_train = compliant(300);
  arm.joints[0].drive_train.gear_ratio = 10;
  arm.joints[0].drive_train.rotor_inertia = 2e-3;  // 0.2 kg m² at the output
  const System system(arm, {{"hinge", DriveKind::torque}});
  const flexarm::simulation::Equilibrium rest{.state = system.rigid_state({0}), .loads = weightless};
  const Modes found = modes(system, rest, 2);
  CHECK(found.frequency_hz[0] < 1e-4);  // turns freely as a whole
  CHECK(2 * std::numbers::pi * found.frequency_hz[1] == near(std::sqrt(300 * (1 / 0.5 + 1 / 0.2)), 1e-8));
}

TEST_CASE("Frequencies do not change when arm, base and gravity turn together") {
  Random random(3);
  const Frame Q = flexarm::geometry::exp6(random.twist(1, 2));
  auto turned = spatial_arm();
  turned.joints[0].origin = Q * turned.joints[0].origin;
  const auto of = [](const flexarm::model::Arm& arm, const Vector3d& g) {
    const System system(arm, {});
    return modes(system, static_equilibrium(system, {0.1, 0.05, 0.2}, {.gravity = g}), 5);
  };
  const Modes here = of(spatial_arm(), {0, 0, -9.81}), there = of(turned, Q.R * Vector3d(0, 0, -9.81));
  for (std::size_t k = 0; k < 5; ++k) {
    CHECK(there.frequency_hz[k] == near(here.frequency_hz[k], 1e-8));
    CHECK(there.damping_ratio[k] == near(here.damping_ratio[k], 1e-6));
  }
}

TEST_CASE("The tip moves across the arm in its first mode") {
  const Modes found = modes_of(paper_arm(), 0, weightless, 2);
  for (int k = 0; k < 2; ++k) {
    const Vector6d shape = found.shapes.col(k);
    CHECK(std::abs(shape[0]) < 1e-8 * largest(shape));
    CHECK(shape.segment<2>(1).norm() > 0);
  }
}

}  // namespace flexarm::tests::modal_test
