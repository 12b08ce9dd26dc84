#include "flexarm/simulation/reactions.hpp"

#include <doctest/doctest.h>

#include "arms.hpp"
#include "flexarm/integrators/hht.hpp"
#include "flexarm/simulation/statics.hpp"

namespace flexarm::tests::reactions_test {

using namespace flexarm::simulation;
using flexarm::integrators::DriveValues;
using flexarm::integrators::HhtCoefficients;
using flexarm::integrators::HhtStepper;

namespace {

/// Weight less inertia of everything that moves, as force and moment about the base's origin.
Vector6d weight_less_inertia(const System& system, const State& state, const Loads& loads) {
  Vector6d sum = Vector6d::Zero();
  const auto add = [&](int node, const Vector6d& f) {
    sum += flexarm::geometry::adjoint(state.frames[node].inverse()).transpose() * f;
  };
  for (const auto& beam : system.beams()) {
    const int n1 = 6 * beam.node1(), n2 = 6 * beam.node2();
    flexarm::elements::Vector12d v, v_dot;
    v << state.v.segment<6>(n1), state.v.segment<6>(n2);
    v_dot << state.v_dot.segment<6>(n1), state.v_dot.segment<6>(n2);
    const auto f = beam.inertia_forces(v, v_dot);
    add(beam.node1(), -f.head<6>());
    add(beam.node2(), -f.tail<6>());
  }
  for (const auto& body : system.bodies()) {
    const int n = 6 * body.node();
    add(body.node(), -body.inertia_forces(state.v.segment<6>(n), state.v_dot.segment<6>(n)));
  }
  for (int n = 0; n < system.n_nodes(); ++n) {
    add(n, system.weights()[n].force(state.frames[n].R, loads.gravity));
  }
  return sum;
}

}  // namespace

TEST_CASE("Section forces of a hanging arm are its weights, those of a horizontal one shear and moment") {
  const System system(paper_arm(), {{"hinge", DriveKind::motor_angle}});
  const double payload = 14.1 * standard_gravity, tube = 5.82e-4 * 7850 * 3 * standard_gravity;
  const auto hanging = static_equilibrium(system, {half_pi}, Loads{});
  const SectionForces down = section_forces(system, hanging.state, Loads{}, 0);
  CHECK(down.start[0] == near(payload + tube, 1e-9));
  CHECK(down.end[0] == near(payload, 1e-9));
  CHECK(largest(down.start.tail<5>()) < 1e-6);

  const auto level = static_equilibrium(system, {0}, Loads{});
  const SectionForces across = section_forces(system, level.state, Loads{}, 0);
  const Frame& tip = level.state.frames.back();
  CHECK(error(tip.R * across.end.head<3>(), Vector3d(0, 0, -payload)) < 1e-8 * payload);
  CHECK(largest(across.end.tail<3>()) < 1e-6);  // a point mass at the tip: no moment
  const Matrix3d& R = system.meshes()[0].R_LS;  // section axes; the hinge itself has not turned
  CHECK(error(R * across.start.head<3>(), Vector3d(0, 0, -payload - tube)) < 1e-8 * payload);
  // Moment at the hinge about y: weights times their horizontal distances; 3 mm of them lost by bending.
  CHECK((R * across.start.tail<3>()).y() == near(payload * tip.x.x() + tube * 1.5, 1e-4));
}

TEST_CASE("Joint and motor torque of a resting arm balance the moment of its weight") {
  const System system(paper_arm({.hub_stiffness = 1e5}), {{"hinge", DriveKind::motor_angle}});
  const auto rest = static_equilibrium(system, {0.4}, Loads{});
  const double moment = base_wrench(system, rest.state)[4];
  CHECK(joint_torque(system, rest.state, 0) == near(-moment, 1e-9));
  CHECK(motor_torques(system, rest.state, false)[0] == near(-moment, 1e-9));
  const auto& at = system.joints()[0];
  CHECK(1e5 * (rest.state.s[at.phi] - rest.state.s[at.theta]) == near(-moment, 1e-9));
}

TEST_CASE("In motion the base carries weight less inertia, to 1e-8") {
  const System system(
      spatial_arm(),
      {{"turn", DriveKind::torque}, {"slide", DriveKind::motor_angle}, {"lift", DriveKind::motor_angle}});
  const Loads loads{.gravity = {0.5, 1, -9.5}};
  State state = static_equilibrium(system, {0.1, 0.05, 0.2}, loads).state;
  const VectorXd zero = VectorXd::Zero(system.n_scalars());
  DriveValues held{state.s, zero, zero, zero};
  held.torques[system.joints()[0].phi] = 15;  // swings the column
  HhtStepper stepper(system, HhtCoefficients::from_alpha(-0.1), loads, {.tolerance = 1e-12});
  for (int k = 0; k < 60; ++k) {
    stepper.advance(state, 5e-3, [&](double, DriveValues& values) { values = held; });
  }
  CHECK(state.v.norm() > 0.5);
  const Vector6d expected = weight_less_inertia(system, state, loads), wrench = base_wrench(system, state);
  CHECK(error(wrench.head<3>(), expected.head<3>()) < 1e-8 * largest(expected.head<3>()));
  CHECK(error(wrench.tail<3>(), expected.tail<3>()) < 1e-8 * largest(expected.tail<3>()));
  CHECK(error(expected.head<3>(), system.mass() * loads.gravity) > 1);  // inertia matters here
}

TEST_CASE("A swinging rigid pendulum pulls at its hinge with m (g cos θ + c θ'²)") {
  const double m = 2, c = 0.7;
  const System system(pendulum(m, c, 0.1), {{"hinge", DriveKind::free}});
  State state = system.rigid_state({0.5});
  const double rate = 1.3;
  state.v[4] = state.v[6] = rate;
  balance(system, Loads{}, state);
  const Vector3d force = base_wrench(system, state).head<3>();
  const Vector3d along = state.frames[0].R * Vector3d(0, 0, -1);
  CHECK(force.dot(along) == near(m * (standard_gravity * std::cos(0.5) + c * rate * rate), 1e-9));
  // and its own equation of motion: (J + m c²) θ'' = −m g c sin θ
  CHECK(state.v_dot[6] == near(-m * standard_gravity * c * std::sin(0.5) / (0.1 + m * c * c), 1e-9));
}

}  // namespace flexarm::tests::reactions_test
