#include "flexarm/simulation/backlash.hpp"

#include <algorithm>
#include <cmath>

namespace flexarm::simulation {
namespace {

using joints::Flank;

// A torque below this part of k b is none: it deflects the spring by a millionth of the gap.
constexpr double no_torque = 1e-6;

/// Calls visit(spring, memory, deflection of the spring) for every law with a gap.
template <class Visit>
void for_each_gap(const System& system, State& state, Visit&& visit) {
  for (std::size_t k = 0; k < system.laws().size(); ++k) {
    const assembly::PlacedLaw& law = system.laws()[k];
    if (!joints::has_gap(law.law)) continue;
    const double d = joints::spring_deflection(law.law, system.deflection(law, state.s), state.laws[k],
                                               system.argument(law, state));
    visit(*joints::spring_of(law.law), state.laws[k], d);
  }
}

/// Both coordinates of a pin with play see the other as it was before.
void open_pins(const System& system, State& state) {
  const Eigen::VectorXd before = state.s;
  for (std::size_t k = 0; k < system.laws().size(); ++k) {
    const assembly::PlacedLaw& law = system.laws()[k];
    const auto* pin = std::get_if<joints::RadialClearance>(&law.law);
    if (pin == nullptr) continue;
    state.s[law.plus] *= pin->opened(before[law.plus], before[law.of]);
    state.laws[k].flank = Flank::free;
  }
}

}  // namespace

bool has_gaps(const System& system) {
  return std::any_of(system.laws().begin(), system.laws().end(), [](const assembly::PlacedLaw& law) {
    return joints::has_gap(law.law) || std::holds_alternative<joints::RadialClearance>(law.law);
  });
}

void close_gaps(const System& system, State& state) {
  for (std::size_t k = 0; k < system.laws().size(); ++k) state.laws[k].flank = Flank::closed;
}

void open_gaps(const System& system, State& state) {
  for_each_gap(system, state, [](const auto& spring, joints::LawMemory& memory, double x) {
    const double torque = spring.respond(x, 0, memory).force;
    const bool pushed = std::abs(torque) > no_torque * spring.stiffness * spring.gap;
    memory.flank = !pushed ? Flank::free : torque > 0 ? Flank::positive : Flank::negative;
  });
  open_pins(system, state);
}

bool correct_flanks(const System& system, State& state, bool stable) {
  bool changed = false;
  for_each_gap(system, state, [&](const auto& spring, joints::LawMemory& memory, double x) {
    const double half = 0.5 * spring.gap, a_little = no_torque * spring.gap;
    const Flank before = memory.flank;
    if (before == Flank::free) {
      if (x > half) memory.flank = Flank::positive;
      if (x < -half) memory.flank = Flank::negative;
      if (std::abs(x) <= half && !stable) memory.flank = Flank::negative;
    } else if ((before == Flank::positive ? x : -x) < half - a_little) {
      memory.flank = Flank::free;
    }
    changed = changed || memory.flank != before;
  });
  return changed;
}

}  // namespace flexarm::simulation
