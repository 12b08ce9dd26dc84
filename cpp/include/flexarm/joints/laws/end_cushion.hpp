/// @file
/// End stops with cushions, as of a hydraulic cylinder: on the last way w before an end the oil is throttled,
/// and at the end the piston meets its head. With x_e the nearer end, σ = ±1 its side, and d = σ (x − x_e)
/// how far x is beyond it,
///
///     Q = σ (k max(d, 0) + c g(u) max(σ x', 0)),    u = 1 + d/w                                       (1)
///     g = 0 for u ≤ 0,   3 u² − 2 u³ for 0 < u < 1,   1 for u ≥ 1                                     (2)
///
/// The throttle works towards the end only: a check valve lets oil in on the way back. Units: x and w in rad,
/// k in N m/rad, c in N m s/rad.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "flexarm/errors.hpp"
#include "flexarm/joints/law_response.hpp"

namespace flexarm::joints {

struct EndCushion {
  double low, high;    ///< the two ends
  double stiffness;    ///< k
  double length;       ///< w
  double damping = 0;  ///< c

  static constexpr bool acts_at_rest = true;

  bool operator==(const EndCushion&) const = default;

  LawResponse respond(double x, double x_dot, const LawMemory&) const {
    const double side = x > 0.5 * (low + high) ? 1 : -1;
    const double d = side > 0 ? x - high : low - x, rate = std::max(side * x_dot, 0.0);
    const double u = std::clamp(1 + d / length, 0.0, 1.0);
    const double c = damping * u * u * (3 - 2 * u), c_x = damping * 6 * u * (1 - u) / length;  // eq. (2)
    const double pressed = std::max(d, 0.0);
    return {.force = side * (stiffness * pressed + c * rate),  // eq. (1)
            .stiffness = (d > 0 ? stiffness : 0) + c_x * rate,
            .damping = rate > 0 ? c : 0,
            .energy = 0.5 * stiffness * pressed * pressed,
            .loss = side * c * rate};
  }

  void check() const {
    const auto require = [](bool holds, const std::string& what, double value, const std::string& unit) {
      if (!holds || !std::isfinite(value))
        throw InvalidParameter(what + ", got " + std::to_string(value) + " " + unit);
    };
    require(std::isfinite(low), "lower end must be finite", low, "rad");
    require(high > low, "upper end must lie above the lower one", high, "rad");
    require(stiffness > 0, "stiffness of the ends must be positive", stiffness, "N m/rad");
    require(length > 0 && length <= 0.5 * (high - low),
            "length of the cushions must be positive and at most half the way", length, "rad");
    require(damping >= 0, "damping of the cushions must not be negative", damping, "N m s/rad");
  }
};

}  // namespace flexarm::joints
