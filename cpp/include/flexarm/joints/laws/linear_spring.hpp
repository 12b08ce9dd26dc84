/// @file
/// Linear spring and damper:  Q = k x + c x'.  Units: N m/rad and N m s/rad (N/m and N s/m on a prismatic
/// joint).
#pragma once

#include <string>

#include "flexarm/errors.hpp"
#include "flexarm/joints/law_response.hpp"

namespace flexarm::joints {

struct LinearSpring {
  double stiffness;    ///< k
  double damping = 0;  ///< c

  static constexpr bool acts_at_rest = true;

  LawResponse respond(double x, double x_dot, const LawMemory&) const {
    const double loss = damping * x_dot;
    return {.force = stiffness * x + loss,
            .stiffness = stiffness,
            .damping = damping,
            .energy = 0.5 * stiffness * x * x,
            .loss = loss};
  }

  void check() const {
    if (!(stiffness > 0)) {
      throw InvalidParameter("joint stiffness must be positive, got " + std::to_string(stiffness) +
                             " N m/rad");
    }
    if (!(damping >= 0)) {
      throw InvalidParameter("joint damping must not be negative, got " + std::to_string(damping) +
                             " N m s/rad");
    }
  }
};

}  // namespace flexarm::joints
