#include "flexarm/joints/drive_train.hpp"

#include <doctest/doctest.h>

#include "arms.hpp"
#include "flexarm/simulation/reactions.hpp"
#include "flexarm/simulation/statics.hpp"

namespace flexarm::tests::drive_train_test {

using namespace flexarm::joints;
using flexarm::simulation::static_equilibrium;

namespace {

/// Sag of a horizontal weightless lever of 2 m with 5 kg at its end behind a drive train [rad].
double sag(const DriveTrain& train) {
  flexarm::model::Arm arm;
  arm.links = {flexarm::model::RigidLink{"lever", 5, {2, 0, 0}, Matrix3d::Zero()}};
  arm.joints = {{.name = "hinge", .child = "lever", .axis = Vector3d::UnitY(), .drive_train = train}};
  const System system(arm, {{"hinge", DriveKind::motor_angle}});
  return static_equilibrium(system, {0.0}, Loads{}).state.s[system.joints()[0].theta];
}

DriveTrain of_stages(std::vector<DriveTrain::Parallel> stages) {
  DriveTrain train;
  train.stages = std::move(stages);
  return train;
}

}  // namespace

TEST_CASE("A spring holds the weight at k θ = m g r cos θ") {
  const double k = 900, theta = sag(compliant(k));
  CHECK(k * theta == near(5 * 9.81 * 2 * std::cos(theta), 1e-10));
}

TEST_CASE("Two springs in series are one of k₁ k₂/(k₁ + k₂)") {
  const double k1 = 700, k2 = 1900;
  const double series = sag(of_stages({{ReducerSpring{k1}}, {ReducerSpring{k2}}}));
  CHECK(series == near(sag(compliant(k1 * k2 / (k1 + k2))), 1e-10));
  const double three =
      sag(of_stages({{ReducerSpring{3 * k1}}, {ReducerSpring{3 * k1}}, {ReducerSpring{3 * k1}}}));
  CHECK(three == near(sag(compliant(k1)), 1e-10));
}

TEST_CASE("Springs in parallel add, a cubic one among them") {
  CHECK(sag(of_stages({{ReducerSpring{700}, ReducerSpring{400}}})) == near(sag(compliant(1100)), 1e-10));
  const double theta = sag(of_stages({{ReducerSpring{.stiffness = 700, .cubic_stiffness = 5e4}}}));
  CHECK(700 * theta + 5e4 * theta * theta * theta == near(5 * 9.81 * 2 * std::cos(theta), 1e-10));
}

TEST_CASE("Friction has no part in where the arm settles") {
  DriveTrain train = compliant(900);
  const double without = sag(train);
  train.stages[0].push_back(DahlFriction{50, 1e-3});
  train.bearing = {DahlFriction{30, 1e-3}, ViscousFriction{5}};
  CHECK(sag(train) == near(without, 1e-12));
}

TEST_CASE("A bearing's spring acts against the housing, beside the drive train") {
  DriveTrain train = compliant(900);
  train.bearing = {CableTorque{300}};
  CHECK(sag(train) == near(sag(compliant(1200)), 1e-10));
}

TEST_CASE("The rotor's inertia is seen through the square of the ratio") {
  DriveTrain train;
  train.gear_ratio = 120;
  train.rotor_inertia = 3e-4;
  CHECK(train.reflected_inertia() == near(14400 * 3e-4));
  CHECK(DriveTrain{}.reflected_inertia() == 0);
}

TEST_CASE("Where the link's angle is driven, the drive train does not matter") {
  flexarm::model::Arm arm = paper_arm({.elements = 2, .hub_stiffness = 1e5});
  const System through(arm, {{"hinge", DriveKind::link_angle}});
  const System rigid(paper_arm({.elements = 2}), {{"hinge", DriveKind::motor_angle}});
  const auto tip = [](const System& system) {
    return system.point_frame(static_equilibrium(system, {0.3}, Loads{}).state, 0).x;
  };
  CHECK(error(tip(through), tip(rigid)) < 1e-12);
}

}  // namespace flexarm::tests::drive_train_test
