/// @file
/// Cubic stiffening, added to a linear spring:  Q = k₃ x³.  Unit: N m/rad³.
#pragma once

#include <string>

#include "flexarm/errors.hpp"
#include "flexarm/joints/law_response.hpp"

namespace flexarm::joints {

struct CubicSpring {
  double stiffness;  ///< k₃

  static constexpr bool acts_at_rest = true;

  LawResponse respond(double x, double, const LawMemory&) const {
    const double x2 = x * x;
    return {
        .force = stiffness * x2 * x, .stiffness = 3 * stiffness * x2, .energy = 0.25 * stiffness * x2 * x2};
  }

  void check() const {
    if (!(stiffness >= 0)) {
      throw InvalidParameter("cubic stiffness must not be negative, got " + std::to_string(stiffness) +
                             " N m/rad³");
    }
  }
};

}  // namespace flexarm::joints
