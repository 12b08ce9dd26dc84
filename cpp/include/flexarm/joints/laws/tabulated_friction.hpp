/// @file
/// Friction whose torque a table of the deflection gives:
///
///     Q = f(x) z,    z' = (1 − z sgn x') x'/w                                                         (1)
///
/// with Dahl's z [Dahl1968] (dahl_friction.hpp), which is the direction of motion except within the width w.
/// With a table of the mean of two branches it forms a hysteresis law. Where f is negative it drives.
#pragma once

#include "flexarm/joints/law_response.hpp"
#include "flexarm/joints/laws/dahl_friction.hpp"
#include "flexarm/joints/laws/monotone_cubic.hpp"

namespace flexarm::joints {

struct TabulatedFriction {
  MonotoneCubic table;  ///< f [N m]; N along a slide
  double width;         ///< w [rad]; m along a slide

  static constexpr bool acts_at_rest = false;

  bool operator==(const TabulatedFriction&) const = default;

  LawResponse respond(double x, double x_dot, const LawMemory& memory) const {
    LawResponse r = DahlFriction{1, width}.respond(x, x_dot, memory);
    const auto f = table(x);
    r.stiffness = f.y * r.stiffness + f.first * r.z;
    for (double* each : {&r.force, &r.loss, &r.force_by_x0, &r.force_by_z0}) *each *= f.y;  // eq. (1)
    return r;
  }

  void check() const { DahlFriction{1, width}.check(); }
};

}  // namespace flexarm::joints
