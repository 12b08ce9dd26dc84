#include "flexarm/simulation/snapshots.hpp"

#include "flexarm/integrators/increment.hpp"
#include "flexarm/simulation/recorder.hpp"

namespace flexarm::simulation {
namespace {

using geometry::Vector3d;
using geometry::Vector6d;

/// Nodes move so far in the central difference, in m and rad.
constexpr double small = 1e-5;

Vector6d point_velocity(const System& system, State state, int point, double along) {
  integrators::move(system, along * state.v.head(system.n_free()), state);
  return system.point_velocity(state, point);
}

Vector6d own_acceleration(const System& system, const State& state, int point) {
  State accelerated = state;
  accelerated.v = state.v_dot;
  const Vector6d linear = system.point_velocity(accelerated, point);
  const double fastest = state.v.cwiseAbs().maxCoeff();
  if (fastest == 0 || system.points()[point].element < 0) return linear;
  const double e = small / fastest;
  return linear + (point_velocity(system, state, point, e) - point_velocity(system, state, point, -e)) /
                      (2 * e);  // eq. (1)
}

}  // namespace

Vector3d point_acceleration(const System& system, const State& state, int point) {
  const Vector6d V = system.point_velocity(state, point), V_dot = own_acceleration(system, state, point);
  const Vector3d v = V.head<3>(), omega = V.tail<3>();
  return system.point_frame(state, point).R * (V_dot.head<3>() + omega.cross(v));  // eq. (1)
}

Snapshots snapshots(const System& system, const std::vector<State>& states, const Loads& loads) {
  const auto n = static_cast<Eigen::Index>(states.size());
  const auto n_points = static_cast<int>(system.points().size());
  Snapshots found;
  TransientOptions options;
  options.record_rotations = options.record_forces = true;
  Recorder recorder(system, options, n, found.run);
  found.acceleration.resize(3 * n_points, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const State& state = states[static_cast<std::size_t>(k)];
    recorder.write(k, state, loads);
    for (int p = 0; p < n_points; ++p) {
      found.acceleration.col(k).segment<3>(3 * p) = point_acceleration(system, state, p);
    }
  }
  return found;
}

State displaced(const System& system, const State& state, const Eigen::VectorXd& increment,
                const Eigen::VectorXd& v, const Eigen::VectorXd& v_dot) {
  State moved = state;
  integrators::move(system, increment, moved);
  moved.v.head(system.n_free()) = v;
  moved.v_dot.head(system.n_free()) = v_dot;
  return moved;
}

}  // namespace flexarm::simulation
