/// @file
/// The spring of a reducer that winds up by more than its torque makes of it:
///
///     x = d + w,    Q = Q_s(d, x')                                                                  (1)
///
/// x is the deflection between teeth and link, Q_s the reducer's spring and damper (reducer_spring.hpp), and
/// w a table of the link's angle, of its rate, or of the spring's own torque T = Q_s(d, 0). With T (1) is one
/// equation for T,
///
///     T = Q_s(x − w(T), 0)                                                                           (2)
///
/// solved by Newton's method within the bracket that the least and the largest w give. Its tangent is
/// Q_s'/(1 + Q_s' w'); the solution is single where no part of the table falls as steeply as −1/Q_s'. The
/// damper spans both: it acts on x'. A table that changes at an instant takes or gives energy. Units: w in
/// rad, T in N m.
#pragma once

#include <algorithm>
#include <cmath>

#include "flexarm/joints/law_response.hpp"
#include "flexarm/joints/laws/changing_table.hpp"
#include "flexarm/joints/laws/reducer_spring.hpp"

namespace flexarm::joints {

struct WoundSpring {
  ReducerSpring spring;
  Of of;  ///< angle, rate or torque
  ChangingTable windup;

  static constexpr bool acts_at_rest = true;

  bool operator==(const WoundSpring&) const = default;

  /// d of (1).
  double deflection(double x, const LawMemory& memory, const LawArgument& y) const {
    const TableAtInstant w = windup.at(y.time);
    return x - (of == Of::torque ? w(torque(x, memory, w)).y : at(y).y);
  }

  LawResponse respond(double x, double x_dot, const LawMemory& memory, const LawArgument& y) const {
    if (of == Of::torque) return respond_by_torque(x, x_dot, memory, windup.at(y.time));
    const auto w = at(y);
    LawResponse r = spring.respond(x - w.y, x_dot, memory);
    (of == Of::angle ? r.force_by_y : r.force_by_y_rate) = -r.stiffness * w.first;
    r.loss = r.force;  // what the spring does not hold
    return r;
  }

  void check() const {
    spring.check();
    windup.check();
    if (of == Of::motor_angle)
      throw InvalidParameter("the teeth wind up with the motor's angle, not the spring");
    const double fall = -windup.least_slope() * spring.stiffness;
    if (of == Of::torque && fall >= 1) {
      throw InvalidParameter("windup that falls with the torque by " + std::to_string(fall) +
                             " of the spring's own rise leaves it no stiffness; it must stay below 1");
    }
  }

 private:
  MonotoneCubic::Value at(const LawArgument& y) const {
    return windup.at(y.time)(of == Of::rate ? y.rate : y.value);
  }

  /// T of (2).
  double torque(double x, const LawMemory& memory, const TableAtInstant& table) const {
    const auto [least, most] = table.range();
    const auto held = [&](double w) { return spring.respond(x - w, 0, memory); };
    double low = held(most).force, high = held(least).force;
    double T = std::clamp(held(0).force, low, high);
    for (int k = 0; k < 100 && low < high; ++k) {
      const auto w = table(T);
      const LawResponse now = held(w.y);
      const double error = now.force - T;
      (error > 0 ? low : high) = T;
      double next = T + error / (1 + now.stiffness * w.first);
      if (!(next > low && next < high)) next = 0.5 * (low + high);
      if (std::abs(next - T) <= 1e-15 * std::max(std::abs(low), std::abs(high))) return next;
      T = next;
    }
    return T;
  }

  LawResponse respond_by_torque(double x, double x_dot, const LawMemory& memory,
                                const TableAtInstant& table) const {
    const double T = torque(x, memory, table);
    const auto w = table(T);
    const double d = x - w.y, d_x = 1 / (1 + spring.respond(d, 0, memory).stiffness * w.first);
    LawResponse r = spring.respond(d, x_dot, memory);
    r.stiffness *= d_x;
    r.energy += T * w.y - table.integral(T);  // so that its derivative by x is T
    if (windup.changes()) r.loss = r.force;
    return r;
  }
};

}  // namespace flexarm::joints
