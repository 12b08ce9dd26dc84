/// @file
/// Equilibrium at rest:  r(H, s, λ) = 0 of assembly/system.hpp with v = v' = 0, by Newton's method,
///
///     [K  Φ_qᵀ; Φ_q  0] (Δ, Δλ) = −(r, Φ),    H := H exp(Δ)                                       (1)
///
/// with the true tangent K, geometric stiffness included. Where the full load is too much for one solution,
/// it grows in steps. A solution counts only if it is stable, i.e. K + ρ Φ_qᵀ Φ_q has no negative pivot; the
/// load fraction where that ends is the buckling load. Friction has no part: the arm settles where no
/// friction holds it. Teeth of reducers lie on the flanks that backlash.hpp finds.
#pragma once

#include "flexarm/assembly/system.hpp"

namespace flexarm::simulation {

using assembly::Loads;
using assembly::State;
using assembly::System;

struct StaticOptions {
  double tolerance =
      1e-9;  ///< of the last increment, in parts of the reach and rad; the error left is its square
  int max_iterations = 40;  ///< a load step
  int max_halvings = 10;    ///< of the load step
  double time = 0;          ///< at which laws count that change at an instant [s]
};

struct Equilibrium {
  State state;
  Loads loads;
  int iterations = 0, load_steps = 0;
  double residual = 0;  ///< largest unbalanced force left [N, N m]
};

/// @param joint_values drive angle (φ) of every joint; where the joint is free, the value to start from.
/// @throws NotConverged with the load fraction reached, and whether the arm buckles there.
Equilibrium static_equilibrium(const System& system, const std::vector<double>& joint_values,
                               const Loads& loads, const StaticOptions& options = {});

/// Whether the equilibrium would return from any small displacement.
bool is_stable(const System& system, const State& state, const Loads& loads);

}  // namespace flexarm::simulation
