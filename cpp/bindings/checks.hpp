/// @file
/// What the core takes for granted, asked of arguments that come from Python.
#pragma once

#include <string>

#include "flexarm/errors.hpp"
#include "flexarm/simulation/statics.hpp"
#include "flexarm/simulation/variation.hpp"

namespace checks {

using flexarm::InvalidParameter;
using flexarm::assembly::Loads;
using flexarm::assembly::State;
using flexarm::assembly::System;
using flexarm::simulation::Equilibrium;
using flexarm::simulation::StateDerivative;

/// @throws InvalidParameter unless there is a k-th of n things.
inline void index(const char* what, Eigen::Index k, std::size_t n) {
  if (k >= 0 && static_cast<std::size_t>(k) < n) return;
  throw InvalidParameter(std::string(what) + " must be a number from 0 to " +
                         std::to_string(static_cast<Eigen::Index>(n) - 1) + ", got " + std::to_string(k));
}

inline void size(const char* what, Eigen::Index found, Eigen::Index wanted) {
  if (found == wanted) return;
  throw InvalidParameter(std::string(what) + " must have " + std::to_string(wanted) + " entries, got " +
                         std::to_string(found));
}

/// @throws InvalidParameter unless the state is one of the system, or of one of its structure.
inline void fits(const System& system, const State& state) {
  const auto n = [](const auto& array) { return static_cast<Eigen::Index>(array.size()); };
  size("frames of a state", n(state.frames), system.n_nodes());
  size("scalar coordinates of a state", n(state.s), system.n_scalars());
  for (const auto* v : {&state.v, &state.v_dot, &state.a})
    size("velocities of a state", n(*v), system.n_velocities());
  size("multipliers of a state", n(state.multipliers), system.n_constraints());
  size("laws of a state", n(state.laws), n(system.laws()));
}

inline void fits(const System& system, const Loads& loads) {
  if (!loads.gravity.allFinite()) throw InvalidParameter("gravity must be finite");
  for (const auto& load : loads.points) {
    index("point of a load", load.point, system.points().size());
    if (!load.force.allFinite() || !load.moment.allFinite())
      throw InvalidParameter("force and moment of a load must be finite");
  }
  if (loads.torques.size() > 0) size("torques of loads", loads.torques.size(), system.n_scalars());
}

inline void fits(const System& system, const Equilibrium& equilibrium) {
  fits(system, equilibrium.state);
  fits(system, equilibrium.loads);
}

inline void fits(const System& system, const StateDerivative& derivative, Eigen::Index n_parameters) {
  size("derivative of a state", derivative.position.rows(), system.n_velocities());
  size("derivative of multipliers", derivative.multipliers.rows(), system.n_constraints());
  size("derivative of laws", derivative.law_x.rows(), static_cast<Eigen::Index>(system.laws().size()));
  size("parameters of a derivative", derivative.size(), n_parameters);
}

/// @throws InvalidParameter unless two systems are of one arm, whatever drives its joints.
inline void same_arm(const System& held, const System& system) {
  bool same = held.n_nodes() == system.n_nodes() && held.joints().size() == system.joints().size() &&
              held.n_scalars() == system.n_scalars() && held.laws().size() == system.laws().size() &&
              held.n_constraints() == system.n_constraints() &&
              held.superelements().size() == system.superelements().size() &&
              held.hinges().size() == system.hinges().size();
  for (std::size_t k = 0; same && k < system.superelements().size(); ++k)
    same = held.superelements()[k].n_modes() == system.superelements()[k].n_modes();
  if (!same) throw InvalidParameter("the two systems must be of the same arm");
}

}  // namespace checks
