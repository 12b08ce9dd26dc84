/// @file
/// Increments of a state: nodes move along the group, H := H exp(h); scalar coordinates and multipliers add.
#pragma once

#include "flexarm/assembly/system.hpp"

namespace flexarm::solvers {

using assembly::State;
using assembly::System;
using Eigen::VectorXd;

/// Moves nodes and free scalar coordinates by the first n_free() entries of `dx`.
void move(const System& system, const Eigen::Ref<const VectorXd>& dx, State& state);

/// Largest entry of an increment, translations and sliding joints in parts of the arm's reach, rotations in
/// rad.
double increment_norm(const System& system, const Eigen::Ref<const VectorXd>& dx);

}  // namespace flexarm::solvers
