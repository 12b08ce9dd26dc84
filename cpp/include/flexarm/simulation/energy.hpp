/// @file
/// Energies and powers of an arm in a state.
///
///     kinetic ½ vᵀ M v,   elastic ½ eᵀ K e and the laws' own,   gravity −g · Σ (m x + R s)            (1)
///
/// For the exact motion  d/dt (kinetic + elastic + gravity) = work − loss, the work of growing bows and of
/// tables of a joint's state included.
/// Units: J, W.
#pragma once

#include "flexarm/assembly/equations.hpp"

namespace flexarm::simulation {

using assembly::LoadsIn;
using assembly::StateIn;
using assembly::SystemIn;

struct Energies {
  double kinetic = 0, elastic = 0, gravity = 0;
  double dissipation = 0;  ///< what the damping of beams and super-elements takes [W]
  double bow_power = 0;    ///< what growing bows give the beams [W], equation (7) of elements/beam.hpp
  double table_power = 0;  ///< what loads of assembly/state_loads.hpp give [W]
  double in_passage = 0;   ///< part of elastic: of laws with a second argument, whose loss is all their force
};

/// Equation (1), and the powers of the elements.
template <int D>
Energies energies(const SystemIn<D>& system, const StateIn<D>& state, const LoadsIn<D>& loads);

/// What the damping of beams and super-elements takes [W].
template <int D>
double link_dissipation(const SystemIn<D>& system, const StateIn<D>& state) {
  return energies(system, state, LoadsIn<D>{}).dissipation;
}

/// Dissipating force of every joint law at the state, to be summed over its deflection [N m].
template <int D>
void law_losses(const SystemIn<D>& system, const StateIn<D>& state, Eigen::VectorXd& loss);

/// Power of the point loads [W].
template <int D>
double load_power(const SystemIn<D>& system, const StateIn<D>& state, const LoadsIn<D>& loads);

}  // namespace flexarm::simulation
