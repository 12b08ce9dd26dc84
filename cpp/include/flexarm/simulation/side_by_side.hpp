/// @file
/// Runs of arms of one structure along one drive, several at a time in vector registers (lanes/stepper.hpp).
#pragma once

#include <optional>
#include <vector>

#include "flexarm/simulation/transient.hpp"

namespace flexarm::simulation {

/// How many arms this processor takes side by side; 0: none.
int arms_side_by_side();

/// An arm and where it starts.
struct Variant {
  const System* system;
  const Equilibrium* equilibrium;
};

/// Runs along the same drives with the same options; nothing for an arm that is to run alone: one that does
/// not move in a plane or does not suit (lanes/arm_numbers.hpp), or whose iteration failed. A run differs
/// from `simulate` by rounding, and where the end of an iteration hangs on that, by a part of its tolerance;
/// by no bit with what else is in `variants`.
/// @throws InvalidParameter as `simulate`.
std::vector<std::optional<Transient>> simulate_side_by_side(const std::vector<Variant>& variants,
                                                            const std::vector<PiecewisePolynomial>& drives,
                                                            const TransientOptions& options,
                                                            const Progress& progress = {});

}  // namespace flexarm::simulation
