/// @file
/// Energies and powers of an arm in a state.
///
///     kinetic ½ vᵀ M v,   elastic ½ eᵀ K e and the laws' own,   gravity −g · Σ (m x + R s)            (1)
///
/// For the exact motion  d/dt (kinetic + elastic + gravity) = work − loss, the work of growing bows included.
/// Units: J, W.
#pragma once

#include "flexarm/assembly/system.hpp"

namespace flexarm::simulation {

using assembly::Loads;
using assembly::State;
using assembly::System;

struct Energies {
  double kinetic = 0, elastic = 0, gravity = 0;
};

/// Equation (1).
Energies energies(const System& system, const State& state, const Loads& loads);

/// What the damping of beams and super-elements takes [W].
double link_dissipation(const System& system, const State& state);

/// Dissipating force of every joint law at the state, to be summed over its deflection [N m].
Eigen::VectorXd law_losses(const System& system, const State& state);

/// What growing bows give the beams [W], equation (7) of elements/beam.hpp.
double bow_power(const System& system, const State& state);

/// Power of the point loads [W].
double load_power(const System& system, const State& state, const Loads& loads);

}  // namespace flexarm::simulation
