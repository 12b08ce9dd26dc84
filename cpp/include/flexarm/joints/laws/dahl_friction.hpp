/// @file
/// Coulomb friction in Dahl's form: rate-independent, sticks over a small width, saturates at the Coulomb
/// torque.
///
///     Q = T_c z,    z' = (1 − z sgn x') x'/w                                                     (1)
///
/// Along a path of one direction s = sgn(Δx) equation (1) has the exact solution
///
///     z₁ = s − (s − z₀) exp(−|Δx|/w)                                                            (2)
///
/// which the implicit step uses as it stands: no integration error, whatever the step. Between motor and
/// link, with a width of its own, the same law is the hysteresis of a reducer. Units: T_c in N m, w in rad.
/// Source: [Dahl1968]; docs/theory.md, section "Joints and drive trains".
#pragma once

#include <cmath>
#include <string>

#include "flexarm/errors.hpp"
#include "flexarm/joints/law_response.hpp"

namespace flexarm::joints {

struct DahlFriction {
  double torque;        ///< T_c
  double width = 2e-5;  ///< w

  static constexpr bool acts_at_rest = false;

  bool operator==(const DahlFriction&) const = default;

  LawResponse respond(double x, double, const LawMemory& memory) const {
    const double dx = x - memory.x;
    const double s = dx < 0 ? -1.0 : 1.0;
    const double decay = std::exp(-std::abs(dx) / width);
    const double z = s - (s - memory.z) * decay;  // eq. (2)
    const double force = torque * z, z_x = (1 - s * z) / width;
    return {.force = force,
            .stiffness = torque * z_x,
            .loss = force,
            .z = z,
            .force_by_x0 = -torque * z_x,
            .force_by_z0 = torque * decay,
            .z_by_x = z_x,
            .z_by_x0 = -z_x,
            .z_by_z0 = decay};
  }

  void check() const {
    if (!(torque >= 0 && std::isfinite(torque))) {
      throw InvalidParameter("friction torque must not be negative, got " + std::to_string(torque) + " N m");
    }
    if (!(width > 0 && std::isfinite(width))) {
      throw InvalidParameter("friction width must be positive, got " + std::to_string(width) + " rad");
    }
  }
};

}  // namespace flexarm::joints
