/// @file
/// Viscous friction:  Q = b x'.  Unit: N m s/rad.
#pragma once

#include <cmath>
#include <string>

#include "flexarm/errors.hpp"
#include "flexarm/joints/law_response.hpp"

namespace flexarm::joints {

struct ViscousFriction {
  double coefficient;  ///< b

  static constexpr bool acts_at_rest = true;

  bool operator==(const ViscousFriction&) const = default;

  LawResponse respond(double, double x_dot, const LawMemory&) const {
    const double force = coefficient * x_dot;
    return {.force = force, .damping = coefficient, .loss = force};
  }

  void check() const {
    if (!(coefficient >= 0 && std::isfinite(coefficient))) {
      throw InvalidParameter("viscous friction must not be negative, got " + std::to_string(coefficient) +
                             " N m s/rad");
    }
  }
};

}  // namespace flexarm::joints
