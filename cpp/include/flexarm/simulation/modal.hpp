/// @file
/// Modes of an arm about a loaded equilibrium, drives held: eigen/eigenmodes.hpp with the true tangent,
/// geometric stiffness and gravity included. Friction has no part.
#pragma once

#include "flexarm/eigen/eigenmodes.hpp"
#include "flexarm/simulation/statics.hpp"

namespace flexarm::simulation {

struct Modes {
  std::vector<double> frequency_hz;   ///< undamped
  std::vector<double> damping_ratio;  ///< of the damped system, mode by mode in the same order
  std::vector<double> damped_frequency_hz;
  Eigen::MatrixXd shapes;  ///< (6 (point, mode)): translation and rotation of each point, base axes
  int iterations = 0;
};

/// @throws NotConverged
Modes modes(const System& system, const Equilibrium& equilibrium, int count);

}  // namespace flexarm::simulation
