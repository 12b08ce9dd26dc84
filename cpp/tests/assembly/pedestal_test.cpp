/// A base that turns on a spring about an axis through its origin.
#include <doctest/doctest.h>

#include "flexarm/simulation/energy.hpp"
#include "flexarm/simulation/reactions.hpp"
#include "flexarm/simulation/sampled_run.hpp"
#include "parts.hpp"

using namespace flexarm::tests;
using namespace flexarm::simulation;

namespace {

constexpr double k = 2e4;
const Vector3d axis = Vector3d(0.2, 1, -0.3);

flexarm::model::Arm on_pedestal(flexarm::model::Arm arm) {
  arm.pedestal = flexarm::model::Pedestal{.axis = axis, .stiffness = k, .damping = 20};
  return arm;
}

}  // namespace

TEST_CASE("A pedestal turns by the moment of the arm's weight over its stiffness") {
  const System system(on_pedestal(spatial_arm()), {});
  const Loads loads{.gravity = {1, 2, -9}};
  const auto rest = static_equilibrium(system, {0.3, 0.1, -0.2}, loads);
  const Vector6d wrench = base_wrench(system, rest.state);
  const double angle = rest.state.s[system.pedestal().theta];
  CHECK(error(wrench.head<3>(), system.mass() * loads.gravity) < 1e-7);
  CHECK(std::abs(angle) > 1e-4);
  CHECK(angle == near(wrench.tail<3>().dot(axis.normalized()) / k, 1e-8));
}

TEST_CASE("An arm on a pedestal stands as the arm whose base was turned by as much") {
  const System system(on_pedestal(spatial_arm()), {});
  const auto rest = static_equilibrium(system, {0.3, 0.1, -0.2}, Loads{});
  const double angle = rest.state.s[system.pedestal().theta];
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
  CHECK(free.state.s[system.pedestal().theta] == rest.state.s[held.pedestal().theta]);
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
