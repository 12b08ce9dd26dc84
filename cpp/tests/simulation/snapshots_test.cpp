#include "flexarm/simulation/snapshots.hpp"

#include <doctest/doctest.h>

#include "arms.hpp"

namespace flexarm::tests::snapshots_test {

using namespace flexarm::simulation;

namespace {

/// The paper's arm with a point in the middle of an element, swinging.
System swinging() {
  auto arm = paper_arm({.elements = 2});
  arm.points.push_back({.name = "inside", .link = "tube", .position = {0.7, 0.1, 0.05}});
  return {arm, {{"hinge", DriveKind::motor_angle}}};
}

/// With the forces of the time stepping, which are those of its states, as a snapshot's are.
Transient swing(const System& system, double step) {
  Eigen::MatrixXd cubic(4, 1);
  cubic << 3, 1, 0, half_pi;
  return simulate(system, static_equilibrium(system, {half_pi}, Loads{}), {{{0, 1}, cubic}},
                  {.end = 0.3, .step = step, .consistent_forces = false});
}

}  // namespace

TEST_CASE("The acceleration of a point is the derivative of its velocity") {
  const System system = swinging();
  const Transient run = swing(system, 5e-4);
  const State& now = run.final_state;
  // The motion goes on from the state by velocities and accelerations of the nodes, to second order.
  const double e = 1e-4;
  const int n = system.n_free();
  const auto at = [&](double t) {
    State moved = displaced(system, now, t * now.v.head(n) + 0.5 * t * t * now.v_dot.head(n),
                            now.v.head(n) + t * now.v_dot.head(n), now.v_dot.head(n));
    return moved;
  };
  for (int p : {0, 1}) {
    const auto velocity = [&](double t) -> Vector3d {
      const State moved = at(t);
      return system.point_frame(moved, p).R * system.point_velocity(moved, p).head<3>();
    };
    const Vector3d expected = (velocity(e) - velocity(-e)) / (2 * e);
    CHECK(expected.norm() > 1);
    CHECK(error(point_acceleration(system, now, p), expected) < 1e-6 * expected.norm());
  }
}

TEST_CASE("A snapshot of a run's last state is the run's last column") {
  const System system = swinging();
  const Transient run = swing(system, 2e-3);
  const Snapshots found = snapshots(system, {run.final_state, run.final_state}, Loads{});
  const Eigen::Index last = run.time.size() - 1;
  CHECK(found.run.time.size() == 2);
  CHECK(error(found.run.position.col(1), run.position.col(last)) < 1e-15);
  CHECK(error(found.run.velocity.col(1), run.velocity.col(last)) < 1e-15);
  CHECK(error(found.run.motor_torque.col(1), run.motor_torque.col(last)) < 1e-9);
  CHECK(found.run.orientation.col(0).head<4>().norm() == near(1));
}

}  // namespace flexarm::tests::snapshots_test
