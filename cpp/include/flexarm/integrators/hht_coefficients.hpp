/// @file
/// Coefficients of a step of integrators/hht.hpp and of its iteration matrix, eq. (5) there.
#pragma once

#include "flexarm/assembly/equations.hpp"

namespace flexarm::integrators {

/// Coefficients of (2)-(4) of hht.hpp. α = 0 is the trapezoidal rule, α = −1/3 damps most.
struct HhtCoefficients {
  double alpha, beta, gamma;

  /// @throws InvalidParameter if α lies outside [−1/3, 0].
  static HhtCoefficients from_alpha(double alpha);
  /// α = (ρ − 1)/(ρ + 1), with ρ in [½, 1] the spectral radius as h → ∞.
  static HhtCoefficients from_spectral_radius(double rho);
  double spectral_radius() const { return (1 + alpha) / (1 - alpha); }
};

/// The shortest time step [s]. Sound passes 5 µm of steel in it, far less than a finite element; much below
/// it 1/(β h²) overflows.
constexpr double shortest_step = 1e-9;

/// @throws InvalidParameter unless a step is finite and at least shortest_step.
void check_step(double h);

/// Scale s of constraints, times β h²: a node's share of the mass [kg].
template <int D>
double constraint_scale(const assembly::SystemIn<D>& system) {
  return std::max(system.mass(), 1e-12) / std::max(1, system.n_nodes());
}

/// What M, C, K and Φ_q are multiplied by in the iteration matrix. @param scale that of the constraints.
assembly::TangentFactors step_factors(const HhtCoefficients& coefficients, double h, double scale);

}  // namespace flexarm::integrators
