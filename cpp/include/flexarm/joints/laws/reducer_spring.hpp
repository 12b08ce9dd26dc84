/// @file
/// The spring of a reducer: linear, stiffening, with backlash, and damped where its teeth touch.
///
///     Q = k e + k₃ e³ + ρ k (x − e) + c g x'                                                        (1)
///     e = x − b/2 for x > b/2,   x + b/2 for x < −b/2,   0 in between                               (2)
///     g = 1 where the teeth touch (|x| ≥ b/2),
///         r + (1 − r) (1 − 3 u² + 2 u³) inside the gap, u = min(1, (b/2 − |x|)/w)                   (3)
///
/// b is the full width of the gap; without one, e = x and g = 1. Inside the gap the damping fades over the
/// width w, so that the torque has no jump where the teeth meet, down to the part r of it, which lets a loose
/// tooth come to rest. The part ρ of the stiffness that stays there holds a tooth without torque in the
/// middle of the gap. It adds at most ρ k b/2 to the torque, as if the gap were smaller by its part ρ.
/// Every term grows with x, so the torque says on which flank the teeth lie.
///
/// The energy is that of the first three terms, exactly; c g x' dissipates. Units: k in N m/rad, k₃ in
/// N m/rad³, c in N m s/rad, b and w in rad; m and N on a prismatic joint. docs/theory.md, section "Joints
/// and drive trains".
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "flexarm/errors.hpp"
#include "flexarm/joints/law_response.hpp"

namespace flexarm::joints {

struct ReducerSpring {
  double stiffness;               ///< k
  double damping = 0;             ///< c
  double cubic_stiffness = 0;     ///< k₃
  double gap = 0;                 ///< b
  double fade_width = 2e-5;       ///< w
  double loose_stiffness = 1e-4;  ///< ρ [-]
  double loose_damping = 1e-2;    ///< r [-]

  static constexpr bool acts_at_rest = true;

  bool operator==(const ReducerSpring&) const = default;

  LawResponse respond(double x, double x_dot, const LawMemory& memory) const {
    const double play = in_gap(x, memory.flank), e = x - play;
    const bool loose = memory.flank == Flank::free && std::abs(x) < 0.5 * gap;
    const auto [g, g_x] = fading(x, loose);
    const double loss = damping * g * x_dot, k_loose = loose_stiffness * stiffness;
    const double e2 = e * e;
    return {
        .force = (stiffness + cubic_stiffness * e2) * e + k_loose * play + loss,  // eq. (1)
        .stiffness = (loose ? k_loose : stiffness) + 3 * cubic_stiffness * e2 + damping * g_x * x_dot,
        .damping = damping * g,
        .energy = (0.5 * stiffness + 0.25 * cubic_stiffness * e2) * e2 + k_loose * play * (e + 0.5 * play),
        .loss = loss};
  }

  void check() const {
    require(stiffness > 0, "joint stiffness must be positive", stiffness, "N m/rad");
    require(damping >= 0, "joint damping must not be negative", damping, "N m s/rad");
    require(cubic_stiffness >= 0, "cubic stiffness must not be negative", cubic_stiffness, "N m/rad³");
    require(gap >= 0, "gap of the backlash must not be negative", gap, "rad");
    require(fade_width > 0, "width over which contact damping fades must be positive", fade_width, "rad");
    require(loose_stiffness > 0 && loose_stiffness <= 1, "stiffness left in the gap must be a part up to 1",
            loose_stiffness, "");
    require(loose_damping >= 0 && loose_damping <= 1, "damping left in the gap must be a part from 0 to 1",
            loose_damping, "");
  }

 private:
  /// x − e of (2): the part of the deflection that the gap takes. A flank that statics holds is touched from
  /// either side.
  double in_gap(double x, Flank flank) const {
    switch (flank) {
      case Flank::closed:
        return 0;
      case Flank::positive:
        return 0.5 * gap;
      case Flank::negative:
        return -0.5 * gap;
      default:
        return std::clamp(x, -0.5 * gap, 0.5 * gap);
    }
  }

  struct Fading {
    double g, g_x;
  };

  /// Equation (3) and its derivative by x.
  Fading fading(double x, bool loose) const {
    if (!loose) return {1, 0};
    const double u = (0.5 * gap - std::abs(x)) / fade_width;
    if (u >= 1) return {loose_damping, 0};
    const double g_u = -6 * (1 - loose_damping) * u * (1 - u);
    return {loose_damping + (1 - loose_damping) * (1 - u * u * (3 - 2 * u)),
            (x < 0 ? g_u : -g_u) / fade_width};
  }

  static void require(bool holds, const std::string& what, double value, const std::string& unit) {
    if (!holds || !std::isfinite(value))
      throw InvalidParameter(what + ", got " + std::to_string(value) + (unit.empty() ? "" : " ") + unit);
  }
};

}  // namespace flexarm::joints
