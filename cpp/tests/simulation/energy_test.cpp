#include "flexarm/simulation/energy.hpp"

#include <doctest/doctest.h>

#include "parts.hpp"

namespace flexarm::tests::energy_test {

using namespace flexarm::simulation;

namespace {

void check_power_balance(const System& system) {
  Loads loads{.gravity = {1, 2, -9}};
  loads.points = {{.point = 0, .force = {3, 4, 5}, .moment = {1, -1, 2}},
                  {.point = 1, .force = {-3, 2, 1}, .moment = {0, 1, 2}, .follows = true}};
  loads.torques = VectorXd::LinSpaced(system.n_scalars(), 1, 3);
  State state = random_state(system, 3);
  // Velocities that the joints permit.
  const MatrixXd J = system.constraint_jacobian(state);
  state.v -= J.transpose() * (J * J.transpose()).ldlt().solve(J * state.v);
  balance(system, loads, state);
  const int n = system.n_free();
  const auto total_after = [&](double t) {
    State there = state;
    flexarm::integrators::move(system, t * state.v.head(n), there);
    there.v += t * state.v_dot;
    const Energies E = energies(system, there, loads);
    return E.kinetic + E.elastic + E.gravity;
  };
  double loss = link_dissipation(system, state);
  VectorXd losses;
  law_losses(system, state, losses);
  for (std::size_t k = 0; k < system.laws().size(); ++k) {
    loss += losses[static_cast<Eigen::Index>(k)] *
            system.deflection(system.laws()[k], state.v.tail(system.n_scalars()));
  }
  const double work = load_power(system, state, loads) + loads.torques.dot(state.v.tail(system.n_scalars()));
  CHECK(loss > 0);
  CHECK(derivative(total_after, 0, 1e-4) == near(work - loss, 1e-6));
}

}  // namespace

TEST_CASE("A pendulum has ½ (J + m c²) θ'² and −m g c cos θ") {
  const double m = 2, c = 0.7, J = 0.1, theta = 0.6, rate = 1.4;
  const System system(pendulum(m, c, J), {{"hinge", DriveKind::free}});
  State state = system.rigid_state({theta});
  state.v[4] = state.v[6] = rate;
  const Energies E = energies(system, state, Loads{});
  CHECK(E.kinetic == near(0.5 * (J + m * c * c) * rate * rate));
  CHECK(E.gravity == near(-m * standard_gravity * c * std::cos(theta)));
  CHECK(E.elastic == 0);
}

TEST_CASE("Rotors count with the square of their ratio, springs with ½ k x²") {
  auto arm = pendulum(2, 0.7, 0.1);
  arm.joints[0].drive_train.stages = {{ReducerSpring{.stiffness = 800, .cubic_stiffness = 4000}}};
  arm.joints[0].drive_train.gear_ratio = 50;
  arm.joints[0].drive_train.rotor_inertia = 1e-3;
  const System system(arm, {{"hinge", DriveKind::torque}});
  State state = system.rigid_state({0});
  const int phi = system.joints()[0].phi;
  state.s[phi] = 0.1;
  state.v[system.scalar_offset() + phi] = 3;
  const Energies E = energies(system, state, Loads{});
  CHECK(E.kinetic == near(0.5 * 2500 * 1e-3 * 9));
  CHECK(E.elastic == near(0.5 * 800 * 0.01 + 0.25 * 4000 * 1e-4));
}

TEST_CASE("Power of all forces equals the rate of change of all energies") {
  auto arm = spatial_arm();
  for (auto& joint : arm.joints)
    joint.drive_train.rotor_inertia = 0.1;  // every coordinate can be accelerated
  arm.joints[1].drive_train.stages.resize(1);
  check_power_balance(
      System(arm, {{"turn", DriveKind::torque}, {"slide", DriveKind::torque}, {"lift", DriveKind::torque}}));
}

TEST_CASE("With super-elements, too, power equals the rate of change of all energies") {
  auto arm = tripod_arm();
  for (auto& joint : arm.joints) joint.drive_train.rotor_inertia = 0.1;
  check_power_balance(System(arm, {{"turn", DriveKind::torque}, {"wrist", DriveKind::torque}}));
}

}  // namespace flexarm::tests::energy_test
