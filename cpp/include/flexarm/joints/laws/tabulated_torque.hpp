/// @file
/// A torque at the output bearing that a table gives:  Q = f(y),  with y the joint's angle x, its rate x', or
/// the motor's angle; f may change at an instant. Of the angle alone it stores the integral of f; else it
/// takes or gives energy.
#pragma once

#include "flexarm/joints/law_response.hpp"
#include "flexarm/joints/laws/changing_table.hpp"

namespace flexarm::joints {

struct TabulatedTorque {
  Of of;  ///< angle, rate or motor_angle
  ChangingTable table;

  static constexpr bool acts_at_rest = true;

  bool operator==(const TabulatedTorque&) const = default;

  LawResponse respond(double x, double x_dot, const LawMemory&, const LawArgument& y) const {
    const double at = of == Of::angle ? x : of == Of::rate ? x_dot : y.value;
    const TableAtInstant f = table.at(y.time);
    const auto [force, slope, curvature] = f(at);
    switch (of) {
      case Of::angle:
        if (table.changes()) return {.force = force, .stiffness = slope, .loss = force};
        return {.force = force, .stiffness = slope, .energy = f.integral(x)};
      case Of::rate:
        return {.force = force, .damping = slope, .loss = force};
      default:
        return {.force = force, .loss = force, .force_by_y = slope};
    }
  }

  void check() const {
    table.check();
    if (of == Of::torque) throw InvalidParameter("a torque is a table of angle, rate or motor angle");
  }
};

}  // namespace flexarm::joints
