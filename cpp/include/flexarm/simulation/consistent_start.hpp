/// @file
/// Accelerations at the instant at which motors are let go: the arm rests, held, or moves as it is told, and
/// from then on torques act that need not hold it. At the same positions and velocities v, w and λ̃ are those
/// of
///
///     A (w, λ̃ − λ) = −(r, c₀),   A = [M  Φ_qᵀ; Φ_q  0]                                               (1)
///
/// with r the balance of forces under the torques and c₀ = Φ'' without accelerations. From accelerations of
/// zero the first step would err by h w/2 in velocities, which stays: a motion of first order. A coordinate
/// without mass that no constraint carries, such as a motor without rotor behind a spring, has no
/// acceleration but a jump. Then the start stays as it is. Derivatives by a parameter follow from (1),
///
///     A d(w, λ̃)/dp = −d(r, c)/dp at fixed w and λ̃,   c = Φ_q w                                        (2)
///
/// Source: [Arnold2015]; docs/theory.md, section "Time stepping".
#pragma once

#include "flexarm/simulation/statics.hpp"
#include "flexarm/simulation/variation.hpp"

namespace flexarm::simulation {

/// The equilibrium with w and λ̃ of (1) under the torques of `drives` at `time`; itself where no motor is
/// driven by torque and nothing moves. Prescribed coordinates of an arm that moves have the drives' rates.
Equilibrium consistent_start(const System& system, const Equilibrium& equilibrium,
                             const integrators::Drives& drives, double time);

/// The derivative of that start from the one of its equilibrium, eq. (2).
/// @param torques derivatives of the torques, one row a scalar coordinate; empty: zero
StateDerivative consistent_start(const System& system, const Equilibrium& start, double time,
                                 const std::vector<Variation>& variations, StateDerivative derivative,
                                 const Slopes& torques = {});

}  // namespace flexarm::simulation
