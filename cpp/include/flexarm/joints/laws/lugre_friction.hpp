/// @file
/// Friction by the LuGre model: bristles that bend, slip, and hold less once they move.
///
///     Q = σ₀ z + σ₁ z' + σ₂ v,    z' = v − σ₀ |v| z/g(v),    v = x'                                 (1)
///     g(v) = F_c + (F_s − F_c) exp(−(v/v_s)²)                                                       (2)
///
/// z is the mean bending of the bristles [rad], F_s the torque at which they break away, F_c the one at which
/// they slip, v_s the speed between the two (Stribeck). Along a path Δx of one direction s = sgn(Δx), with g
/// at the rate of its end, (1) has the exact solution
///
///     z₁ = s g/σ₀ − (s g/σ₀ − z₀) E,    E = exp(−σ₀ |Δx|/g)                                         (3)
///
/// which the implicit step takes as it stands: it is stable for every step, stays below the break-away torque
/// and is exact where the rate is constant; as the rate changes its error is of first order in the step. At
/// rest and at constant g it is Dahl's law of width g/σ₀. Units: σ₀ in N m/rad, σ₁ and σ₂ in N m s/rad, F in
/// N m, v_s in rad/s. Source: [CanudasDeWit1995]; docs/theory.md, section "Joints and drive trains".
#pragma once

#include <cmath>
#include <string>

#include "flexarm/errors.hpp"
#include "flexarm/joints/law_response.hpp"

namespace flexarm::joints {

struct LugreFriction {
  double bristle_stiffness;  ///< σ₀
  double bristle_damping;    ///< σ₁
  double viscous;            ///< σ₂
  double coulomb;            ///< F_c
  double breakaway;          ///< F_s
  double stribeck_rate;      ///< v_s

  static constexpr bool acts_at_rest = false;

  bool operator==(const LugreFriction&) const = default;

  LawResponse respond(double x, double v, const LawMemory& memory) const {
    const double s0 = bristle_stiffness, s1 = bristle_damping;
    const auto [g, g_v] = slipping_torque(v);
    const double path = std::abs(x - memory.x), s = x < memory.x ? -1.0 : 1.0;
    const double decay = std::exp(-s0 * path / g), left = s * g / s0 - memory.z;
    const double z = s * g / s0 - left * decay;  // eq. (3)
    const double z_x = s * left * decay * s0 / g, z_z0 = decay;
    const double z_v = g_v * (s / s0 * (1 - decay) - left * decay * s0 * path / (g * g));
    const double v_abs = std::abs(v), v_sign = v < 0 ? -1.0 : 1.0;
    const double by_z = s0 - s1 * s0 * v_abs / g;                                      // ∂Q/∂z of (1)
    const double by_v = s1 * (1 - s0 * z / g * (v_sign - v_abs * g_v / g)) + viscous;  // ∂Q/∂v at fixed z
    const double force = s0 * z + s1 * (v - s0 * v_abs * z / g) + viscous * v;         // eq. (1)
    return {.force = force,
            .stiffness = by_z * z_x,
            .damping = by_z * z_v + by_v,
            .loss = force,
            .z = z,
            .force_by_x0 = -by_z * z_x,
            .force_by_z0 = by_z * z_z0,
            .z_by_x = z_x,
            .z_by_rate = z_v,
            .z_by_x0 = -z_x,
            .z_by_z0 = z_z0};
  }

  void check() const {
    require(bristle_stiffness > 0, "bristle stiffness must be positive", bristle_stiffness, "N m/rad");
    require(bristle_damping >= 0, "bristle damping must not be negative", bristle_damping, "N m s/rad");
    require(viscous >= 0, "viscous friction must not be negative", viscous, "N m s/rad");
    require(coulomb > 0, "friction torque must be positive", coulomb, "N m");
    require(breakaway >= coulomb, "break-away torque must not be below the friction torque", breakaway,
            "N m");
    require(stribeck_rate > 0, "Stribeck rate must be positive", stribeck_rate, "rad/s");
  }

 private:
  struct SlippingTorque {
    double g, g_v;
  };

  /// Equation (2) and its derivative.
  SlippingTorque slipping_torque(double v) const {
    const double r = v / stribeck_rate, extra = (breakaway - coulomb) * std::exp(-r * r);
    return {coulomb + extra, -2 * r / stribeck_rate * extra};
  }

  static void require(bool holds, const std::string& what, double value, const std::string& unit) {
    if (!holds || !std::isfinite(value))
      throw InvalidParameter(what + ", got " + std::to_string(value) + " " + unit);
  }
};

}  // namespace flexarm::joints
