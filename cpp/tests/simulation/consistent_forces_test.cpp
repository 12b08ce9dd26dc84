#include "flexarm/simulation/consistent_forces.hpp"

#include <doctest/doctest.h>

#include "arms.hpp"
#include "flexarm/integrators/increment.hpp"
#include "flexarm/simulation/statics.hpp"

namespace flexarm::tests::consistent_forces_test {

using namespace flexarm::simulation;
using Eigen::VectorXd;

namespace {

VectorXd residual(const System& system, const State& state) {
  VectorXd r(system.n_velocities());
  system.residual(state, Loads{}, true, r);
  return r.head(system.n_free());
}

VectorXd constraint_acceleration(const System& system, const State& state) {
  VectorXd c(system.n_constraints());
  system.constraint_acceleration(state, c);
  return c;
}

/// Φ_q v of all velocities, prescribed ones included.
VectorXd constraint_rate(const System& system, const State& state) {
  State still = state;  // Φ'' is linear in accelerations; velocities add γ
  still.v.setZero();
  still.v_dot = state.v;
  return constraint_acceleration(system, still);
}

/// The state a little later, moving with its velocities and accelerations.
State later(const System& system, const State& state, double h) {
  State there = state;
  const VectorXd increment = h * state.v;
  flexarm::integrators::move(system, increment.head(system.n_free()), there);
  there.s.tail(system.n_velocities() - system.n_free()) =
      state.s.tail(system.n_velocities() - system.n_free()) +
      increment.tail(system.n_velocities() - system.n_free());
  there.v += h * state.v_dot;
  return there;
}

}  // namespace

TEST_CASE("The acceleration of a constraint is the derivative of its rate") {
  const System system(spatial_arm(), {});
  State state = random_state(system, 3);
  state.v_dot.setRandom();
  const double h = 1e-6;
  const VectorXd difference =
      (constraint_rate(system, later(system, state, h)) - constraint_rate(system, later(system, state, -h))) /
      (2 * h);
  const VectorXd found = constraint_acceleration(system, state);
  CHECK(found.norm() > 1);
  CHECK((difference - found).cwiseAbs().maxCoeff() < 1e-7 * found.cwiseAbs().maxCoeff());
}

TEST_CASE("Consistent forces balance the state and satisfy the constraints' second derivative") {
  const System system(spatial_arm(), {});
  ConsistentForces forces(system);
  for (const unsigned seed : {1, 2, 3}) {  // one object through several angles: kept factors follow
    State state = random_state(system, seed);
    state.v_dot.setRandom();
    state.multipliers.setRandom();
    const VectorXd before = residual(system, state);
    const State& found = forces.of(state);
    CHECK((found.multipliers - state.multipliers).norm() > 1e-3);
    const double size = before.cwiseAbs().maxCoeff() + found.multipliers.cwiseAbs().maxCoeff();
    CHECK((residual(system, found) - before).cwiseAbs().maxCoeff() < 1e-9 * size);
    CHECK(constraint_acceleration(system, found).cwiseAbs().maxCoeff() < 1e-9 * found.v_dot.norm());
    CHECK(&forces.of(system.rigid_state({0, 0, 0})) != &found);  // at rest nothing changes
  }
}

}  // namespace flexarm::tests::consistent_forces_test
