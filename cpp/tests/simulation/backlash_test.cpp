#include "flexarm/simulation/backlash.hpp"

#include <doctest/doctest.h>

#include "arms.hpp"
#include "flexarm/simulation/modal.hpp"
#include "flexarm/simulation/reactions.hpp"
#include "flexarm/simulation/statics.hpp"

namespace flexarm::tests::backlash_test {

using namespace flexarm::simulation;
using flexarm::model::RigidLink;

namespace {

using std::numbers::pi;
constexpr double gap = 4e-4, k = 1e5, loose_part = 1e-4;

/// A lever of 5 kg and 2 m, straight up at zero, with a reducer that has backlash.
flexarm::model::Arm lever(double stiffness = k) {
  flexarm::model::Arm arm;
  arm.links = {RigidLink{"lever", 5, {0, 0, 2}, Matrix3d::Zero()}};
  arm.joints = {{.name = "hinge", .child = "lever", .axis = Vector3d::UnitY()}};
  arm.joints[0].drive_train.stages = {{ReducerSpring{.stiffness = stiffness, .gap = gap}}};
  return arm;
}

/// θ − φ at rest.
double lag(const flexarm::model::Arm& arm, double phi, const Loads& loads = {}) {
  const System system(arm, {{"hinge", DriveKind::motor_angle}});
  const auto rest = static_equilibrium(system, {phi}, loads);
  CHECK(rest.state.laws[0].flank == flexarm::joints::Flank::free);
  CHECK(rest.residual < 1e-9);
  return rest.state.s[system.joints()[0].theta] - phi;
}

}  // namespace

TEST_CASE("Teeth lie on the flank that gravity pushes them against, half a gap and T/k from the motor") {
  for (double phi : {0.5, -0.5, 2.8, -3.0}) {
    const double ahead = lag(lever(), phi), pull = 5 * 9.81 * 2 * std::sin(phi + ahead);
    CAPTURE(phi);
    CHECK(ahead == near(std::copysign(gap / 2 * (1 - loose_part), pull) + pull / k, 1e-9));
  }
}

TEST_CASE("Upright on its ridge the arm leans to its positive angles, by half the gap and T/k") {
  const double ahead = lag(lever(), 0);
  CHECK(ahead == near(gap / 2 * (1 - loose_part) / (1 - 5 * 9.81 * 2 / k), 1e-6));
  CHECK(lag(lever(), 1e-5) > gap / 2);
  CHECK(lag(lever(), -1e-5) < -gap / 2);
}

TEST_CASE("Hanging within the gap of the vertical an arm touches neither flank and hangs plumb") {
  // The part ρ of the stiffness, 10 N m/rad, moves it by a tenth towards its motor.
  const double weight = 5 * 9.81 * 2, phi = pi + 0.3 * gap;
  const double ahead = lag(lever(), phi);
  CHECK(ahead == near(-0.3 * gap * weight / (weight + loose_part * k), 1e-5));
  CHECK(std::abs(lag(lever(), pi + 0.7 * gap) + gap / 2) < 0.25 * gap);
}

TEST_CASE("Without torque a tooth rests in the middle of its gap") {
  CHECK(std::abs(lag(lever(), 0.7, Loads{.gravity = Vector3d::Zero()})) < 1e-12);
}

TEST_CASE("Modes are those of touching teeth, unless the arm rests inside its gap") {
  const auto frequency = [](double phi, const Loads& loads) {
    auto arm = lever();
    const System system(arm, {{"hinge", DriveKind::motor_angle}});
    return modes(system, static_equilibrium(system, {phi}, loads), 1).frequency_hz[0] * 2 * pi;
  };
  const double J = 5 * 4;
  CHECK(frequency(half_pi, {}) == near(std::sqrt(k / J), 1e-4));
  CHECK(frequency(half_pi, Loads{.gravity = Vector3d::Zero()}) == near(std::sqrt(loose_part * k / J), 1e-6));
}

TEST_CASE("Two joints with backlash in series each find their flank") {
  flexarm::model::Arm arm = two_link_arm();
  for (auto& joint : arm.joints) {
    joint.drive_train.stages = {{ReducerSpring{.stiffness = 4000, .gap = gap}}};
  }
  const System system(arm, {{"shoulder", DriveKind::motor_angle}, {"elbow", DriveKind::motor_angle}});
  const auto rest = static_equilibrium(system, {-0.4, 2.2}, Loads{});  // shoulder sags, fore arm stands back
  CHECK(rest.residual < 1e-8);
  for (int j = 0; j < 2; ++j) {
    const auto& at = system.joints()[j];
    const double torque = joint_torque(system, rest.state, j);
    const double d = rest.state.s[at.phi] - rest.state.s[at.theta];
    CHECK(std::abs(torque) > 1);
    CHECK(d == near(std::copysign(gap / 2 * (1 - loose_part), torque) + torque / 4000, 1e-8));
  }
}

}  // namespace flexarm::tests::backlash_test
