/// @file
/// Cables and hoses that bend with a joint:  Q = k (x − x_r).  Units: k in N m/rad, the angle of rest x_r in
/// rad.
#pragma once

#include <cmath>
#include <string>

#include "flexarm/errors.hpp"
#include "flexarm/joints/law_response.hpp"

namespace flexarm::joints {

struct CableTorque {
  double stiffness;       ///< k
  double rest_angle = 0;  ///< x_r

  static constexpr bool acts_at_rest = true;

  bool operator==(const CableTorque&) const = default;

  LawResponse respond(double x, double, const LawMemory&) const {
    const double turned = x - rest_angle;
    return {.force = stiffness * turned, .stiffness = stiffness, .energy = 0.5 * stiffness * turned * turned};
  }

  void check() const {
    if (!(stiffness >= 0 && std::isfinite(stiffness) && std::isfinite(rest_angle))) {
      throw InvalidParameter("stiffness of the cables must not be negative, got " +
                             std::to_string(stiffness) + " N m/rad, and be finite like the rest angle, got " +
                             std::to_string(rest_angle) + " rad");
    }
  }
};

}  // namespace flexarm::joints
