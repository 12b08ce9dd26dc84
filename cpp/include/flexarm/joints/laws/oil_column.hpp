/// @file
/// The oil on both sides of a hydraulic piston, shut in by a valve that has put its stroke to y:
///
///     Q = k(y) x + c x',    k(y) = β (A²/(V₀ + A s) + a²/(V₀ + a (S − s))),    s = y − y₀               (1)
///
/// x is the deflection between the stroke y that the valve has set and the piston, A and a the areas of its
/// two sides, V₀ the dead volume of hoses and ports on each side, y₀ the stroke at which the first chamber is
/// empty, S the whole stroke, and β the bulk modulus of the oil, with its air and its hoses. (1) is the first
/// order of p = β ln(V(y)/V) in the chambers. Beyond the ends k stays as at the end. Under a stroke that
/// moves, the part ½ k' x² y' of the power comes from the valve. Units: areas in m³/rad (m² of a cylinder),
/// V₀ in m³, β in Pa. Source: [Merritt1967].
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "flexarm/errors.hpp"
#include "flexarm/joints/law_response.hpp"

namespace flexarm::joints {

struct OilColumn {
  double bulk_modulus;            ///< β
  double piston_area, ring_area;  ///< A, a
  double dead_volume;             ///< V₀
  double retracted, stroke;       ///< y₀, S
  double damping = 0;             ///< c

  static constexpr bool acts_at_rest = true;
  static constexpr Of of = Of::motor_angle;

  bool operator==(const OilColumn&) const = default;

  LawResponse respond(double x, double x_dot, const LawMemory&, const LawArgument& y) const {
    const double s = std::clamp(y.value - retracted, 0.0, stroke);
    const double V = dead_volume + piston_area * s, v = dead_volume + ring_area * (stroke - s);
    const double A2 = piston_area * piston_area, a2 = ring_area * ring_area;
    const double k = bulk_modulus * (A2 / V + a2 / v);  // eq. (1)
    const bool inside = s == y.value - retracted;
    const double k_y = inside ? bulk_modulus * (a2 * ring_area / (v * v) - A2 * piston_area / (V * V)) : 0;
    const double force = k * x + damping * x_dot;
    return {.force = force,
            .stiffness = k,
            .damping = damping,
            .energy = 0.5 * k * x * x,
            .loss = force,  // what the oil does not hold
            .force_by_y = k_y * x};
  }

  void check() const {
    require(bulk_modulus > 0, "bulk modulus of the oil must be positive", bulk_modulus, "Pa");
    require(piston_area > 0, "area of the piston must be positive", piston_area, "m³/rad");
    require(ring_area >= 0, "area of the ring must not be negative", ring_area, "m³/rad");
    require(dead_volume > 0, "dead volume must be positive", dead_volume, "m³");
    require(std::isfinite(retracted), "retracted stroke must be finite", retracted, "rad");
    require(stroke > 0, "stroke must be positive", stroke, "rad");
    require(damping >= 0, "damping of the oil column must not be negative", damping, "N m s/rad");
  }

 private:
  static void require(bool holds, const std::string& what, double value, const std::string& unit) {
    if (!holds || !std::isfinite(value))
      throw InvalidParameter(what + ", got " + std::to_string(value) + " " + unit);
  }
};

}  // namespace flexarm::joints
