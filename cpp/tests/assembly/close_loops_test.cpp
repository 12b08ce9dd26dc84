#include <doctest/doctest.h>

#include "arms.hpp"
#include "flexarm/errors.hpp"
#include "flexarm/simulation/reactions.hpp"
#include "flexarm/simulation/statics.hpp"

namespace flexarm::tests::close_loops_test {

using flexarm::InvalidParameter;
using flexarm::joints::ClosureType;

namespace {

using Drives = std::map<std::string, DriveKind>;

const Drives by_cylinder = {{"boom_pin", DriveKind::free}, {"cylinder_pin", DriveKind::free}};

double open_by(const System& system, const State& state) {
  return system.closures().residual(state.frames).lpNorm<Eigen::Infinity>();
}

/// Angle of the boom at a stroke, from the triangle of boom pin, cylinder pin and rod eye.
double boom_angle(double stroke) {
  const double to_eye = std::hypot(1.2, 0.1), between = std::hypot(0.3, 0.8), rod = 0.9 + stroke;
  const double at_boom =
      std::acos((to_eye * to_eye + between * between - rod * rod) / (2 * to_eye * between));
  return at_boom - half_pi + std::atan2(0.3, 0.8) + std::atan2(0.1, 1.2);
}

}  // namespace

TEST_CASE("The free joints of a loop follow the driven one as a triangle demands") {
  for (const auto& arm : {crane_arm(), rigid_crane_arm()}) {
    const System system(arm, by_cylinder);
    for (const double stroke : {-0.1, 0.2, 0.5, 0.8}) {
      const State state = system.rigid_state({0, 0, stroke});
      CHECK(open_by(system, state) < 1e-12);
      CHECK(state.s[system.joints()[0].theta] == near(boom_angle(stroke), 1e-10));
    }
  }
}

TEST_CASE(
    "Conditions that a flat loop of rigid links repeats are left out, those of a flexible one are not") {
  CHECK(System(crane_arm(), by_cylinder).closures().redundant() == 0);
  const System rigid(rigid_crane_arm(), by_cylinder);
  CHECK(rigid.closures().redundant() == 3);
  CHECK(rigid.closures().rows() == 2);
  auto arm = rigid_crane_arm();
  arm.closures[0].type = ClosureType::spherical;
  CHECK(System(arm, by_cylinder).closures().redundant() == 1);
}

TEST_CASE("Only the forces of a closure that the repeated conditions share are open") {
  const auto indeterminacy = [](const System& system) {
    return system.closures().indeterminacy(0, system.rigid_state({0, 0, 0.3}).frames);
  };
  CHECK(indeterminacy(System(crane_arm(), by_cylinder)).isZero(0));
  const auto open = indeterminacy(System(rigid_crane_arm(), by_cylinder));  // in the plane x, z
  for (const int across : {1, 3, 5}) CHECK(open[across] > 0.1);
  for (const int within : {0, 2, 4}) CHECK(open[within] < 1e-12);
}

TEST_CASE("A loop that cannot be closed says how far it stays open") {
  auto arm = rigid_crane_arm();
  arm.closures[0].a_origin = Frame::translation({0, 0.05, 0.9});  // beside the plane of the boom
  try {
    const System system(arm, by_cylinder);
    FAIL("closed");
  } catch (const InvalidParameter& error) {
    CHECK(std::string(error.what()).find("'rod_eye' cannot be closed: 0.05 m apart") != std::string::npos);
  }
  const System system(rigid_crane_arm(), by_cylinder);
  try {  // eye and pins in line: 1.2 + 0.85 m at most
    system.rigid_state({0, 0, 1.5});
    FAIL("closed");
  } catch (const InvalidParameter& error) {
    const double most = std::hypot(1.2, 0.1) + std::hypot(0.3, 0.8);
    char text[80];
    std::snprintf(text, sizeof text, "with piston = 1.5: %.3g m apart", 2.4 - most);
    CHECK(std::string(error.what()).find(text) != std::string::npos);
  }
}

TEST_CASE("A drive more than the loop lets move, and a pose in line, are said") {
  const System both(rigid_crane_arm(), {{"cylinder_pin", DriveKind::free}});
  const State closed = System(rigid_crane_arm(), by_cylinder).rigid_state({0, 0, 0.3});
  CHECK_THROWS_AS(both.rigid_state({boom_angle(0.3), 0, 0.3}), InvalidParameter);
  const System system(rigid_crane_arm(), by_cylinder);
  CHECK(system.joints_to_hold({}, {2, 0, 1}) == std::vector<int>{2});
  CHECK(system.joints_to_hold({0}, {2, 1}).empty());
}

TEST_CASE("A bearing gives a closure a pin that stands as its triangle demands") {
  for (auto arm : {crane_arm(), rigid_crane_arm()}) {
    const int redundant = System(arm, by_cylinder).closures().redundant();
    arm.closures[0].bearing = {flexarm::joints::ViscousFriction{5.0}};
    const System system(arm, by_cylinder);
    CHECK(system.closures().redundant() == redundant);
    REQUIRE(system.hinges().size() == 1);
    for (const double stroke : {-0.1, 0.4, 0.8}) {
      const State state = system.rigid_state({0, 0, stroke});
      VectorXd phi(system.n_constraints());
      system.violation(state, phi);
      CHECK(phi.lpNorm<Eigen::Infinity>() < 1e-12);
      const auto angle = [&](int joint) { return state.s[system.joints()[joint].theta]; };
      CHECK(state.s[system.hinges()[0].theta] == near(angle(0) - angle(1), 1e-12));  // boom over cylinder
    }
  }
}

TEST_CASE(
    "A mount of a closure is undeflected before the arm is loaded, and a spherical closure has no bearing") {
  auto arm = crane_arm();
  arm.closures[0].mount = {{.axis = Vector3d::UnitX(), .stiffness = 1e5},
                           {.axis = Vector3d::UnitZ(), .stiffness = 2e5}};
  arm.closures[0].bearing = {flexarm::joints::ViscousFriction{5.0}};
  const System system(arm, by_cylinder);
  const State state = system.rigid_state({0, 0, 0.4});
  VectorXd phi(system.n_constraints());
  system.violation(state, phi);
  CHECK(phi.lpNorm<Eigen::Infinity>() < 1e-12);
  arm.closures[0].type = ClosureType::spherical;
  CHECK_THROWS_AS(System(arm, by_cylinder), InvalidParameter);
}

TEST_CASE("Ends on one link are refused") {
  auto arm = crane_arm();
  arm.closures[0].a = "boom";
  CHECK_THROWS_AS(System(arm, by_cylinder), InvalidParameter);
}

TEST_CASE("A closure on a beam has a node where it sits") {
  const System system(crane_arm(), by_cylinder);
  CHECK(system.meshes()[0].stations == std::vector<double>{0, 1.2, 2});
}

TEST_CASE(
    "The force of the cylinder does the virtual work of the weights, and the base carries all of them") {
  const System system(rigid_crane_arm(), by_cylinder);
  const auto height = [&](double stroke) {
    const State state = system.rigid_state({0, 0, stroke});
    double energy = 0;  // per g
    for (int k = 0; k < system.n_nodes(); ++k)
      energy +=
          (system.weights()[k].mass * state.frames[k].x + state.frames[k].R * system.weights()[k].moment).z();
    return energy;
  };
  const Loads loads{.gravity = {0, 0, -standard_gravity}};
  for (const double stroke : {0.0, 0.4, 0.8}) {
    const auto found = flexarm::simulation::static_equilibrium(system, {0, 0, stroke}, loads);
    const double force = flexarm::simulation::joint_torque(system, found.state, 2);
    CHECK(force == near(standard_gravity * derivative(height, stroke, 1e-3), 1e-10));
    const Vector6d base = flexarm::simulation::base_wrench(system, found.state);
    CHECK(base[2] == near(-standard_gravity * system.mass(), 1e-12));
    CHECK(std::abs(base[0]) < 1e-9);
  }
}

TEST_CASE("A closure to the base carries its share of the weight") {
  auto arm = rigid_crane_arm();
  arm.links.resize(1);
  arm.joints.resize(1);
  arm.closures = {{.name = "prop",
                   .type = ClosureType::spherical,
                   .a = "base",
                   .b = "boom",
                   .a_origin = Frame::translation({2, 0, 1}),
                   .b_origin = Frame::translation({2, 0, 0})}};
  const System system(arm, {{"boom_pin", DriveKind::free}});
  const Loads loads{.gravity = {0, 0, -standard_gravity}};
  const auto found = flexarm::simulation::static_equilibrium(system, {0}, loads);
  const auto prop = flexarm::simulation::closure_force(system, found.state, 0);
  CHECK(prop.wrench[2] == near((8 * 0.5 + 1.5) * standard_gravity, 1e-12));
  const Vector6d base = flexarm::simulation::base_wrench(system, found.state);
  CHECK(base[2] == near(-9.5 * standard_gravity, 1e-12));
  CHECK(base[4] == near((8 * 1 + 1.5 * 2) * standard_gravity, 1e-10));
}

}  // namespace flexarm::tests::close_loops_test
