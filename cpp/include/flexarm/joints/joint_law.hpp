/// @file
/// The laws that act on one scalar deflection x of a drive train, and their common face.
///
/// A law resists the deflection with a force Q(x, x', memory), some with Q(x, x', memory, y, y'); Q is a
/// torque for revolute joints [N m] and a force for prismatic ones [N]. Laws with an internal state
/// (friction, hysteresis) carry it in a `LawMemory` that is renewed when a step is accepted, so that an
/// iterate can be abandoned without trace. A new law is one file in `laws/` with a function `respond`, listed
/// in `JointLaw` below; the assembly and the solvers do not change.
#pragma once

#include <type_traits>
#include <variant>

#include "flexarm/joints/laws/cable_torque.hpp"
#include "flexarm/joints/laws/dahl_friction.hpp"
#include "flexarm/joints/laws/end_cushion.hpp"
#include "flexarm/joints/laws/lugre_friction.hpp"
#include "flexarm/joints/laws/oil_column.hpp"
#include "flexarm/joints/laws/radial_clearance.hpp"
#include "flexarm/joints/laws/reducer_spring.hpp"
#include "flexarm/joints/laws/tabulated_friction.hpp"
#include "flexarm/joints/laws/tabulated_torque.hpp"
#include "flexarm/joints/laws/viscous_friction.hpp"
#include "flexarm/joints/laws/wound_spring.hpp"

namespace flexarm::joints {

using JointLaw =
    std::variant<ReducerSpring, CableTorque, ViscousFriction, DahlFriction, LugreFriction, TabulatedFriction,
                 TabulatedTorque, WoundSpring, OilColumn, EndCushion, RadialClearance>;

inline LawResponse respond(const JointLaw& law, double x, double x_dot, const LawMemory& memory,
                           const LawArgument& y = {}) {
  return std::visit(
      [&](const auto& l) {
        if constexpr (requires { l.of; }) {
          return l.respond(x, x_dot, memory, y);
        } else {
          return l.respond(x, x_dot, memory);
        }
      },
      law);
}

/// Which coordinate of the joint is the second argument of the law, if any: `motor_angle` for φ, `angle` for
/// the link's θ, also for the energy of a windup that changes; `across`; `torque` for none.
inline Of second_argument(const JointLaw& law) {
  if (const auto* table = std::get_if<TabulatedTorque>(&law); table && table->of == Of::motor_angle)
    return Of::motor_angle;
  if (std::holds_alternative<OilColumn>(law)) return Of::motor_angle;
  if (std::holds_alternative<RadialClearance>(law)) return Of::across;
  if (const auto* spring = std::get_if<WoundSpring>(&law);
      spring && (spring->of != Of::torque || spring->windup.changes()))
    return Of::angle;
  return Of::torque;
}

/// Whether the tangent of the law in its deflection is the same in all states.
inline bool is_linear(const JointLaw& law) {
  if (const auto* spring = std::get_if<ReducerSpring>(&law)) {
    return spring->cubic_stiffness == 0 && spring->gap == 0;
  }
  return std::holds_alternative<CableTorque>(law) || std::holds_alternative<ViscousFriction>(law) ||
         (std::holds_alternative<TabulatedTorque>(law) && second_argument(law) == Of::motor_angle);
}

/// Whether the law has a part in statics and modes: friction has none, an arm settles where no friction holds
/// it.
inline bool acts_at_rest(const JointLaw& law) {
  return std::visit([](const auto& l) { return l.acts_at_rest; }, law);
}

/// The reducer's spring of a law; null without one.
inline const ReducerSpring* spring_of(const JointLaw& law) {
  if (const auto* wound = std::get_if<WoundSpring>(&law)) return &wound->spring;
  return std::get_if<ReducerSpring>(&law);
}

/// The deflection of that spring.
inline double spring_deflection(const JointLaw& law, double x, const LawMemory& memory,
                                const LawArgument& y) {
  const auto* wound = std::get_if<WoundSpring>(&law);
  return wound != nullptr ? wound->deflection(x, memory, y) : x;
}

/// Whether the law leaves a gap in which next to nothing holds the deflection.
inline bool has_gap(const JointLaw& law) {
  const ReducerSpring* spring = spring_of(law);
  return spring != nullptr && spring->gap > 0;
}

inline void check(const JointLaw& law) {
  std::visit([](const auto& l) { l.check(); }, law);
}

}  // namespace flexarm::joints
