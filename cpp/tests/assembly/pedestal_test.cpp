/// Hinges that nothing drives: under the base, and between a joint and its parent.
#include <doctest/doctest.h>

#include "flexarm/simulation/energy.hpp"
#include "flexarm/simulation/reactions.hpp"
#include "flexarm/simulation/sampled_run.hpp"
#include "parts.hpp"

namespace flexarm::tests::pedestal_test {

using namespace flexarm::simulation;

namespace {

constexpr double stiffness = 2e4;
const Vector3d axis = Vector3d(0.2, 1, -0.3);

flexarm::model::Arm on_pedestal(flexarm::model::Arm arm) {
  arm.pedestal = flexarm::model::Pedestal{.hinges = {{axis, stiffness, 20}}, .axis = axis};
  return arm;
}

}  // namespace

TEST_CASE("A pedestal turns by the moment of the arm's weight over its stiffness") {
  const System system(on_pedestal(spatial_arm()), {});
  const Loads loads{.gravity = {1, 2, -9}};
  const auto rest = static_equilibrium(system, {0.3, 0.1, -0.2}, loads);
  const Vector6d wrench = base_wrench(system, rest.state);
  const double angle = rest.state.s[system.pedestal().thetas[0]];
  CHECK(error(wrench.head<3>(), system.mass() * loads.gravity) < 1e-7);
  CHECK(std::abs(angle) > 1e-4);
  CHECK(angle == near(wrench.tail<3>().dot(axis.normalized()) / stiffness, 1e-8));
}

TEST_CASE("An arm on a pedestal stands as the arm whose base was turned by as much") {
  const System system(on_pedestal(spatial_arm()), {});
  const auto rest = static_equilibrium(system, {0.3, 0.1, -0.2}, Loads{});
  const double angle = rest.state.s[system.pedestal().thetas[0]];
  auto turned = spatial_arm();
  Vector6d turn = Vector6d::Zero();
  turn.tail<3>() = angle * axis.normalized();
  turned.joints[0].origin = flexarm::geometry::exp6(turn) * turned.joints[0].origin;
  const System still(turned, {});
  const auto reference = static_equilibrium(still, {0.3, 0.1, -0.2}, Loads{});
  for (int point : {0, 1}) {
    CHECK(error(system.point_frame(rest.state, point).x, still.point_frame(reference.state, point).x) <
          1e-10);
  }
  CHECK(error(base_wrench(system, rest.state), base_wrench(still, reference.state)) < 1e-6);
}

TEST_CASE("Joints, links and constraints of the arm keep their numbers on a pedestal") {
  const System bare(spatial_arm(), {}), system(on_pedestal(spatial_arm()), {});
  CHECK(system.joints().size() == bare.joints().size());
  CHECK(system.meshes().size() == bare.meshes().size());
  CHECK(system.n_nodes() == bare.n_nodes() + 1);
  CHECK(system.mass() == near(bare.mass()));
  const auto rest = static_equilibrium(system, {0.3, 0.1, -0.2}, Loads{});
  const double torque = joint_torque(system, rest.state, 2);
  CHECK(motor_torques(system, rest.state, false)[2] ==
        near(torque + 20 * (rest.state.s[system.joints()[2].theta] + 0.1)));
}

TEST_CASE("Let go, an arm of super-elements on a pedestal starts from where it was held") {
  auto arm = on_pedestal(tripod_arm());
  arm.joints[0].drive_train = compliant(5e3);
  const System held(arm, {});
  const System system(arm, {{"turn", DriveKind::torque}});
  const auto rest = static_equilibrium(held, {0.2, 0, -0.1, 0}, Loads{});
  const auto free = released(held, rest, system);
  CHECK(free.state.s[system.pedestal().thetas[0]] == rest.state.s[held.pedestal().thetas[0]]);
  CHECK(energies(system, free.state, Loads{}).elastic == near(energies(held, rest.state, Loads{}).elastic));
}

TEST_CASE("A base is shaken in a sampled run as in a whole one, beside what the motors give") {
  auto arm = on_pedestal(paper_arm({.elements = 2, .hub_stiffness = 1e5, .damping_ratio = 0.01}));
  arm.pedestal->amplitude = 40, arm.pedestal->frequency = 7, arm.pedestal->phase = 0.5;
  arm.joints[0].drive_train.rotor_inertia = 1e-3;
  arm.joints[0].drive_train.gear_ratio = 120;
  const System system(arm, {{"hinge", DriveKind::torque}});
  const auto rest = static_equilibrium(system, {half_pi}, Loads{});
  SampledRun sampled(system, rest, {{}}, {.end = 0.2, .step = 1e-3});
  for (int k = 0; k < 20; ++k) sampled.advance(VectorXd::Constant(1, 150.0), 10);
  const auto run = simulate(system, rest, {PiecewisePolynomial::constant(150)}, {.end = 0.2, .step = 1e-3});
  CHECK(error(sampled.point_position(0), run.position.col(run.time.size() - 1)) < 1e-9);
  arm.pedestal->amplitude = 0;
  const System still(arm, {{"hinge", DriveKind::torque}});
  const auto calm = simulate(still, rest, {PiecewisePolynomial::constant(150)}, {.end = 0.2, .step = 1e-3});
  CHECK(error(calm.position, run.position) > 1e-4);
}

namespace {

/// The same arm with hinges as joints and links of their own, behind its own ones.
flexarm::model::Arm spelt_out(flexarm::model::Arm arm, const std::string& joint) {
  const int k = System(arm, {}).joint_index(joint);
  auto below = arm.joints[k];
  for (const flexarm::model::Hinge& hinge : arm.joints[k].mount) {
    below.name = below.child = "hinge " + std::to_string(arm.links.size());
    below.type = JointType::revolute;
    below.axis = hinge.axis;
    below.drive_train = compliant(hinge.stiffness, hinge.damping);
    below.mount.clear();
    arm.links.push_back(flexarm::model::RigidLink{.name = below.name});
    arm.joints.push_back(below);
    below.parent = below.child;
    below.at_end = false;
    below.origin = Frame{};
  }
  arm.joints[k].parent = below.parent;
  arm.joints[k].at_end = false;
  arm.joints[k].origin = Frame{};
  arm.joints[k].mount.clear();
  return arm;
}

}  // namespace

TEST_CASE(
    "A mount gives way as joints of their own do, at rest and in motion, at the first joint or a later one") {
  for (const int k : {0, 1}) {
    auto arm = spatial_arm();
    arm.joints[k].mount = {{{0.3, 1, 0}, 3e4, 20}, {{0, 0.2, 1}, 2e4, 5}};
    const System mounted(arm, {}), separate(spelt_out(arm, arm.joints[k].name), {});
    const auto rest = static_equilibrium(mounted, {0.3, 0.1, -0.2}, Loads{});
    const auto same = static_equilibrium(separate, {0.3, 0.1, -0.2, 0, 0}, Loads{});
    CHECK(error(base_wrench(mounted, rest.state), base_wrench(separate, same.state)) < 1e-6);
    std::vector<PiecewisePolynomial> moved(3, PiecewisePolynomial({0, 0.3}, MatrixXd{{5}, {1}, {0}, {0.1}}));
    const System driven(arm, {{arm.joints[0].name, DriveKind::motor_angle}});
    const System other(spelt_out(arm, arm.joints[k].name), {{arm.joints[0].name, DriveKind::motor_angle}});
    const auto run = simulate(driven, static_equilibrium(driven, {0.1, 0.1, -0.2}, Loads{}), moved,
                              {.end = 0.3, .step = 2e-3});
    moved.resize(5, PiecewisePolynomial::constant(0));
    const auto reference = simulate(other, static_equilibrium(other, {0.1, 0.1, -0.2, 0, 0}, Loads{}), moved,
                                    {.end = 0.3, .step = 2e-3});
    CHECK(error(run.position, reference.position) < 1e-8);
    CHECK(run.joint_angle.rows() == 3);
  }
}

TEST_CASE("A base on two hinges is shaken about each by its part of the moment") {
  auto arm = paper_arm({.elements = 2, .damping_ratio = 0.01});
  arm.pedestal =
      flexarm::model::Pedestal{.hinges = {{Vector3d::UnitX(), 1e5, 50}, {Vector3d::UnitY(), 1e5, 50}},
                               .axis = {1, 1, 0},
                               .amplitude = 40,
                               .frequency = 3};
  const System system(arm, {});
  CHECK(system.pedestal().moment(0, 0.1) == near(arm.pedestal->moment(0.1) / std::sqrt(2)));
  CHECK(system.pedestal().moment(1, 0.1) == near(arm.pedestal->moment(0.1) / std::sqrt(2)));
}

}  // namespace flexarm::tests::pedestal_test
