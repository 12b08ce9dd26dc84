/// @file
/// Increments of a state: nodes move along the group, H := H exp(h); scalar coordinates and multipliers add.
#pragma once

#include "flexarm/assembly/equations.hpp"

namespace flexarm::integrators {

using assembly::StateIn;
using assembly::SystemIn;
using Eigen::VectorXd;

/// Moves nodes and free scalar coordinates by the first n_free() entries of `dx`.
template <int D>
void move(const SystemIn<D>& system, const Eigen::Ref<const VectorXd>& dx, StateIn<D>& state);

/// H₁ := H₀ exp(h) of some nodes, with h the entries of `exponent` that belong to each.
template <int D>
void move_nodes(const std::vector<int>& nodes, const std::vector<geometry::FrameIn<D>>& before,
                const VectorXd& exponent, std::vector<geometry::FrameIn<D>>& after);

/// Largest entry of an increment, translations and sliding joints in parts of the arm's reach, rotations in
/// rad.
template <int D>
double increment_norm(const SystemIn<D>& system, const Eigen::Ref<const VectorXd>& dx);

/// Lets the laws remember a state that is accepted.
template <int D>
void remember_laws(const SystemIn<D>& system, StateIn<D>& state);

}  // namespace flexarm::integrators
