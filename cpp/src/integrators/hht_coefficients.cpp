#include "flexarm/integrators/hht_coefficients.hpp"

#include <cmath>
#include <cstdio>

#include "flexarm/errors.hpp"

namespace flexarm::integrators {

HhtCoefficients HhtCoefficients::from_alpha(double alpha) {
  if (!(alpha >= -1.0 / 3 - 1e-12 && alpha <= 0)) {
    throw InvalidParameter("alpha of the HHT method must lie in [-1/3, 0], got " + std::to_string(alpha));
  }
  return {alpha, (1 - alpha) * (1 - alpha) / 4, 0.5 - alpha};
}

HhtCoefficients HhtCoefficients::from_spectral_radius(double rho) {
  if (!(rho >= 0.5 && rho <= 1)) {
    throw InvalidParameter("spectral radius of the HHT method must lie in [1/2, 1], got " +
                           std::to_string(rho));
  }
  return from_alpha((rho - 1) / (rho + 1));
}

void check_step(double h) {
  if (h >= shortest_step && std::isfinite(h)) return;
  char text[100];
  std::snprintf(text, sizeof text, "step must be positive, at least %g s and finite, got %g s", shortest_step,
                h);
  throw InvalidParameter(text);
}

assembly::TangentFactors step_factors(const HhtCoefficients& coefficients, double h, double scale) {
  const auto [alpha, beta, gamma] = coefficients;
  const double per_h2 = 1 / (beta * h * h);
  return {per_h2 / (1 + alpha), gamma / (beta * h), 1, scale * per_h2};
}

}  // namespace flexarm::integrators
