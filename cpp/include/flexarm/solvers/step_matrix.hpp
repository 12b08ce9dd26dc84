/// @file
/// Factors of the iteration matrix (5) of solvers/hht.hpp.
#pragma once

#include <algorithm>

#include "flexarm/solvers/hht.hpp"

namespace flexarm::solvers {

/// Scale s of constraints, times β h²: a node's share of the mass [kg].
template <int D>
double constraint_scale(const SystemIn<D>& system) {
  return std::max(system.mass(), 1e-12) / std::max(1, system.n_nodes());
}

inline assembly::TangentFactors step_factors(const HhtCoefficients& coefficients, double h, double scale) {
  const auto [alpha, beta, gamma] = coefficients;
  const double per_h2 = 1 / (beta * h * h);
  return {per_h2 / (1 + alpha), gamma / (beta * h), 1, scale * per_h2};
}

}  // namespace flexarm::solvers
