#include "flexarm/simulation/statics.hpp"

#include <doctest/doctest.h>

#include <numbers>

#include "arms.hpp"
#include "flexarm/errors.hpp"
#include "flexarm/simulation/reactions.hpp"

namespace flexarm::tests::statics_test {

using flexarm::NotConverged;
using flexarm::simulation::Equilibrium;
using flexarm::simulation::is_stable;
using flexarm::simulation::static_equilibrium;
using std::numbers::pi;

namespace {

const Loads weightless{.gravity = Vector3d::Zero()};

/// A clamped upright column of unit Euler load for bending about its weaker axis, of slenderness 2000, so
/// that its shortening under load (π²/4 of the inverse square) does not matter.
flexarm::model::Arm column(double ratio_of_stiffnesses) {
  constexpr double length = 2, slenderness = 2000;
  const double EI = 4 * length * length / (pi * pi);
  const double EA = EI * slenderness * slenderness / (length * length);
  flexarm::model::Arm arm;
  const flexarm::model::Section section{EA, EI * ratio_of_stiffnesses, EI, EI};  // with E = 1
  arm.links = {flexarm::model::BeamLink{.name = "column",
                                        .end = {0, 0, length},
                                        .section = section,
                                        .material = {1, 1, 0},
                                        .theory = flexarm::model::BeamTheory::euler_bernoulli,
                                        .elements = 16}};
  arm.joints = {{.name = "clamp", .type = JointType::fixed, .child = "column"}};
  arm.points = {{.name = "top", .link = "column", .position = {0, 0, length}, .loaded = true}};
  return arm;
}

Loads pressing(double force) {
  Loads loads = weightless;
  loads.points = {{.point = 0, .force = {0, 0, -force}}};
  return loads;
}

Vector3d tip_of(const System& system, const Equilibrium& equilibrium) {
  return system.point_frame(equilibrium.state, 0).x;
}

}  // namespace

TEST_CASE("The paper's arm sags as its reference values, for an inextensible beam, say") {
  struct Row {
    double hub_stiffness, tangential, radial;  // mm
  };
  for (const Row& row : {Row{0, -34.12642, -0.22961}, Row{1e5, -52.61750, -0.49696}}) {
    auto arm = paper_arm({.elements = 16, .hub_stiffness = row.hub_stiffness});
    auto& tube = std::get<flexarm::model::BeamLink>(arm.links[0]);
    tube.section.area *= 1e3;  // EA without ρA: elongation would give back 6e-5 mm
    tube.material.density /= 1e3;
    const System system(arm, {{"hinge", DriveKind::motor_angle}});
    const Vector3d tip = tip_of(system, static_equilibrium(system, {0}, Loads{}));
    CAPTURE(row.hub_stiffness);
    CHECK(std::abs(1e3 * tip.z() - row.tangential) < 1e-5);  // the printed digits
    CHECK(std::abs(1e3 * (tip.x() - 3) - row.radial) < 1e-5);
  }
}

TEST_CASE("Small deflections are P L³/3EI + P L/GA of the tip load, and P/(EA/L) along the beam") {
  auto arm = paper_arm({.elements = 3, .theory = flexarm::model::BeamTheory::timoshenko});
  arm.payloads.clear();
  const System system(arm, {{"hinge", DriveKind::motor_angle}});
  Loads loads = weightless;
  loads.points = {{.point = 0, .force = {5, 0.1, 0.2}}};
  const Vector3d tip = tip_of(system, static_equilibrium(system, {0}, loads));
  const auto s = paper_tube();
  const double lateral = 27 / (3 * 210e9 * s.second_moment_y) + 3 / (80.77e9 * s.shear_area_y);
  CHECK(tip.y() == near(0.1 * lateral, 1e-3));  // tension stiffens by P L²/EI = 1e-3
  CHECK(tip.z() == near(0.2 * lateral, 1e-3));
  CHECK(tip.x() - 3 == near(5 * 3 / (210e9 * s.area), 1e-2));
}

TEST_CASE("A tip moment of 2π EI/L rolls a beam into a circle, exactly, whatever the elements") {
  for (int n : {4, 9}) {
    auto arm = paper_arm({.elements = n});
    arm.payloads.clear();
    // As soft sideways and in torsion as in bending, it would buckle out of its plane on the way.
    auto& section = std::get<flexarm::model::BeamLink>(arm.links[0]).section;
    section.torsion_constant = section.second_moment_y = 1e3 * section.second_moment_z;
    const System system(arm, {{"hinge", DriveKind::motor_angle}});
    Loads loads = weightless;
    loads.points = {{.point = 0, .moment = {0, 2 * pi * 210e9 * 2.37e-7 / 3, 0}, .follows = true}};
    CHECK(largest(tip_of(system, static_equilibrium(system, {0}, loads))) < 1e-8);
  }
}

TEST_CASE("The elastica under a dead load") {
  struct Row {
    double load, w, u;  // P L²/EI, deflection and approach in parts of L
  };
  // Inextensible reference; EA L²/EI = 2e4 here, and elongation changes the tip by less than 1e-3.
  for (const Row& row : {Row{1, 0.30172077, 0.05643324}, Row{5, 0.71379152, 0.38762836}}) {
    auto arm = paper_arm({.elements = 20});
    arm.payloads.clear();
    std::get<flexarm::model::BeamLink>(arm.links[0]).section.area = 100;  // inextensible
    const System system(arm, {{"hinge", DriveKind::motor_angle}});
    Loads loads = weightless;
    loads.points = {{.point = 0, .force = {0, 0, row.load * 210e9 * 2.37e-7 / 9}}};
    const Vector3d tip = tip_of(system, static_equilibrium(system, {0}, loads));
    CAPTURE(row.load);
    CHECK(tip.z() / 3 == near(row.w, 2e-4));
    CHECK(1 - tip.x() / 3 == near(row.u, 5e-4));
  }
}

TEST_CASE("Reactions at the base equal the weight, and its moment, to 1e-8") {
  const System arms[] = {
      System(paper_arm({.hub_stiffness = 1e5}), {{"hinge", DriveKind::motor_angle}}),
      System(two_link_arm(), {{"shoulder", DriveKind::motor_angle}, {"elbow", DriveKind::motor_angle}}),
      System(spatial_arm(),
             {{"turn", DriveKind::locked}, {"slide", DriveKind::locked}, {"lift", DriveKind::locked}})};
  for (const System& system : arms) {
    const Loads loads{.gravity = {1, 2, -9}};
    const auto equilibrium =
        static_equilibrium(system, std::vector<double>(system.joints().size(), 0.2), loads);
    Vector6d weight = Vector6d::Zero();
    for (int n = 0; n < system.n_nodes(); ++n) {
      const Frame& H = equilibrium.state.frames[n];
      const auto& w = system.weights()[n];
      weight.head<3>() += w.mass * loads.gravity;
      weight.tail<3>() += (w.mass * H.x + H.R * w.moment).cross(loads.gravity);
    }
    const Vector6d wrench = flexarm::simulation::base_wrench(system, equilibrium.state);
    CHECK(error(wrench.head<3>(), system.mass() * loads.gravity) < 1e-8 * 9 * system.mass());
    CHECK(error(wrench.tail<3>(), weight.tail<3>()) < 1e-8 * largest(weight.tail<3>()));
  }
}

TEST_CASE("A stiff arm is a rigid arm: the deflection vanishes as 1/E") {
  double before = 0;
  for (double E : {210e9, 210e11, 210e13}) {
    auto arm = paper_arm();
    std::get<flexarm::model::BeamLink>(arm.links[0]).material.youngs_modulus = E;
    const System system(arm, {{"hinge", DriveKind::motor_angle}});
    const auto equilibrium = static_equilibrium(system, {0.5}, Loads{});
    const double sag =
        (tip_of(system, equilibrium) - system.point_frame(system.rigid_state({0.5}), 0).x).norm();
    if (before > 0) CHECK(before / sag == near(100, 0.01));
    before = sag;
  }
  CHECK(before < 1e-5);
}

TEST_CASE("A column stands below π² EI/4 L² and buckles above, about its weaker axis") {
  for (double ratio : {1.0, 7.0}) {
    const System system(column(ratio), {});
    CAPTURE(ratio);
    CHECK_NOTHROW(static_equilibrium(system, {0}, pressing(0.998)));
    CHECK_THROWS_WITH_AS(static_equilibrium(system, {0}, pressing(1.002)),
                         doctest::Contains("the arm buckles at about"), NotConverged);
  }
  const System weaker(column(0.25), {});  // now z bends more easily than y
  CHECK_NOTHROW(static_equilibrium(weaker, {0}, pressing(0.998 / 4)));
  CHECK_THROWS_AS(static_equilibrium(weaker, {0}, pressing(1.002 / 4)), NotConverged);
}

TEST_CASE("The failure tells the fraction of the load at which the column buckles") {
  const System system(column(1), {});
  try {
    static_equilibrium(system, {0}, pressing(4));
    FAIL("a column under four times its Euler load stood");
  } catch (const NotConverged& failure) {
    const std::string text = failure.what();
    const double fraction = std::stod(text.substr(text.find("about ") + 6));
    CHECK(fraction == near(0.25, 0.01));
  }
}

TEST_CASE("Pulling does not buckle a column") {
  const System system(column(1), {});
  CHECK_NOTHROW(static_equilibrium(system, {0}, pressing(-4)));
}

TEST_CASE("A free hinge without gravity has nothing to hold it, and is refused") {
  const System bar(pendulum(2, 1, 0.3), {{"hinge", DriveKind::free}});
  const System beam(paper_arm(), {{"hinge", DriveKind::free}});
  for (const System* system : {&bar, &beam}) {
    CHECK_THROWS_AS(static_equilibrium(*system, {0.3}, weightless), NotConverged);
  }
  CHECK_THROWS_WITH_AS(static_equilibrium(bar, {0.3}, weightless), doctest::Contains("nothing holds the arm"),
                       NotConverged);
}

TEST_CASE("A free pendulum settles hanging, a torque holds it aside") {
  const System bar(pendulum(2, 1, 0.3), {{"hinge", DriveKind::free}});
  CHECK(std::abs(static_equilibrium(bar, {0.8}, Loads{}).state.s[0]) < 1e-10);
  const System held(pendulum(2, 1, 0.3), {{"hinge", DriveKind::torque}});
  Loads loads;
  loads.torques = VectorXd::Constant(1, 2 * standard_gravity * std::sin(0.6));
  CHECK(static_equilibrium(held, {0.1}, loads).state.s[0] == near(0.6, 1e-9));
}

TEST_CASE("A pendulum upside down is no equilibrium that stays") {
  const System bar(pendulum(2, 1, 0.3), {{"hinge", DriveKind::free}});
  CHECK_FALSE(is_stable(bar, bar.rigid_state({pi}), Loads{}));
  CHECK(is_stable(bar, bar.rigid_state({0}), Loads{}));
  CHECK_THROWS_AS(static_equilibrium(bar, {pi}, Loads{}), NotConverged);
}

TEST_CASE("A gear shares the load between its joints") {
  auto arm = two_link_arm();
  for (auto& joint : arm.joints) joint.drive_train = {};
  arm.joints[0].drive_train = compliant(5000);
  arm.gears = {{"belt", "shoulder", "elbow", -1}};  // the forearm keeps its direction in space
  const System system(arm, {{"shoulder", DriveKind::motor_angle}, {"elbow", DriveKind::free}});
  const auto equilibrium = static_equilibrium(system, {0.2, -0.2}, Loads{});
  const auto& at = system.joints();
  const double theta = equilibrium.state.s[at[0].theta];
  CHECK(equilibrium.state.s[at[1].theta] == near(-theta, 1e-12));
  const double spring = 5000 * (theta - 0.2);
  const double M1 = flexarm::simulation::joint_torque(system, equilibrium.state, 0);
  const double M2 = flexarm::simulation::joint_torque(system, equilibrium.state, 1);
  CHECK(M1 - M2 == near(-spring, 1e-8));  // virtual work along the coupled motion
}

TEST_CASE("The equilibrium does not depend on how the load was applied") {
  const System system(
      spatial_arm(),
      {{"turn", DriveKind::locked}, {"slide", DriveKind::locked}, {"lift", DriveKind::locked}});
  Loads loads;
  loads.points = {{.point = 0, .force = {10, 25, -15}}};
  const auto once = static_equilibrium(system, {0.1, 0.05, 0.2}, loads);
  const auto strict = static_equilibrium(system, {0.1, 0.05, 0.2}, loads, {.tolerance = 1e-12});
  CHECK(error(tip_of(system, once), tip_of(system, strict)) < 1e-12);
  VectorXd r(system.n_velocities()), phi(system.n_constraints());
  system.residual(once.state, loads, false, r);
  system.violation(once.state, phi);
  CHECK(largest(r.head(system.n_free())) < 1e-6);
  CHECK(largest(phi) < 1e-13);
}

}  // namespace flexarm::tests::statics_test
