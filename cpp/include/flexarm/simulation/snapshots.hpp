/// @file
/// States looked at one by one: what a run would have recorded there, and the accelerations of points.
///
/// With the velocity V of a point in its own axes (translation v, rotation ω), linear in the nodes'
/// velocities, V = P(H) v_nodes, its acceleration is
///
///     V' = P(H) v'_nodes + [dP(H exp(ε v_nodes))/dε] v_nodes,    x'' = R (v' + ω × v)                 (1)
///
/// The derivative in brackets, zero for points at nodes, is a central difference.
#pragma once

#include "flexarm/simulation/transient.hpp"

namespace flexarm::simulation {

struct Snapshots {
  Transient run;                 ///< one column a state
  Eigen::MatrixXd acceleration;  ///< (3 p, n), of the points, base axes [m/s²]
};

Snapshots snapshots(const System& system, const std::vector<State>& states, const Loads& loads);

/// Acceleration of a point in base axes, equation (1).
geometry::Vector3d point_acceleration(const System& system, const State& state, int point);

/// The state moved by increments of the free coordinates (integrators/increment.hpp), with these velocities
/// and accelerations of theirs.
State displaced(const System& system, const State& state, const Eigen::VectorXd& increment,
                const Eigen::VectorXd& v, const Eigen::VectorXd& v_dot);

}  // namespace flexarm::simulation
