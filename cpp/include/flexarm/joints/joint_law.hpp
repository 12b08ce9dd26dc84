/// @file
/// The laws that act on one scalar deflection x of a drive train, and their common face.
///
/// A law resists the deflection with a force Q(x, x', memory); Q is a torque for revolute joints [N m] and a
/// force for prismatic ones [N]. Laws with an internal state (friction, hysteresis) carry it in a `LawMemory`
/// that is renewed when a step is accepted, so that an iterate can be abandoned without trace. A new law is
/// one file in `laws/` with a function `respond`, listed in `JointLaw` below; the assembly and the solvers do
/// not change.
#pragma once

#include <variant>

#include "flexarm/joints/laws/cable_torque.hpp"
#include "flexarm/joints/laws/dahl_friction.hpp"
#include "flexarm/joints/laws/lugre_friction.hpp"
#include "flexarm/joints/laws/reducer_spring.hpp"
#include "flexarm/joints/laws/viscous_friction.hpp"

namespace flexarm::joints {

using JointLaw = std::variant<ReducerSpring, CableTorque, ViscousFriction, DahlFriction, LugreFriction>;

inline LawResponse respond(const JointLaw& law, double x, double x_dot, const LawMemory& memory) {
  return std::visit([&](const auto& l) { return l.respond(x, x_dot, memory); }, law);
}

/// Whether the law has a part in statics and modes: friction has none, an arm settles where no friction holds
/// it.
inline bool acts_at_rest(const JointLaw& law) {
  return std::visit([](const auto& l) { return l.acts_at_rest; }, law);
}

/// Whether the law leaves a gap in which next to nothing holds the deflection.
inline bool has_gap(const JointLaw& law) {
  const auto* spring = std::get_if<ReducerSpring>(&law);
  return spring != nullptr && spring->gap > 0;
}

inline void check(const JointLaw& law) {
  std::visit([](const auto& l) { l.check(); }, law);
}

}  // namespace flexarm::joints
