/// @file
/// A pin with play in its hole: one of the two coordinates x, y across the axis, each on a slide of its own.
/// With the eccentricity e = |(x, y)|,
///
///     Q_x = F(e) x/e + c g(e) x'                                                                     (1)
///
/// F, c g and the part of the stiffness that is left in the play are those of a spring with a gap
/// (reducer_spring.hpp) whose width is the diameter's play; x and y have one law each. Both together store
/// the energy of F. Units: k in N/m, c in N s/m, gap in m.
#pragma once

#include <cmath>

#include "flexarm/joints/laws/reducer_spring.hpp"

namespace flexarm::joints {

struct RadialClearance {
  ReducerSpring spring;  ///< its gap is twice the radial clearance
  int across = 1;        ///< the hinge of y: 1 the next of the mount, −1 the one before

  static constexpr bool acts_at_rest = true;
  static constexpr Of of = Of::across;

  bool operator==(const RadialClearance&) const = default;

  LawResponse respond(double x, double x_dot, const LawMemory& memory, const LawArgument& y) const {
    const double e = std::hypot(x, y.value);
    const double n_x = e > 0 ? x / e : 0, n_y = e > 0 ? y.value / e : 0;
    const LawResponse still = spring.respond(e, 0, memory), moving = spring.respond(e, x_dot, memory);
    const double tangential = e > 0 ? still.force / e : still.stiffness;
    const double damping_by_e = moving.stiffness - still.stiffness;
    LawResponse r;
    r.force = r.loss = tangential * x + moving.loss;  // eq. (1); a law of two coordinates loses all its force
    r.stiffness = tangential + (still.stiffness - tangential) * n_x * n_x + damping_by_e * n_x;
    r.force_by_y = (still.stiffness - tangential) * n_x * n_y + damping_by_e * n_y;
    r.damping = moving.damping;
    r.energy = 0.5 * still.energy;
    return r;
  }

  /// How far out of the middle the pin moves where its play opens, over how far the spring lets it move.
  double opened(double x, double y) const {
    const double e = std::hypot(x, y);
    return e > 0 ? 1 + 0.5 * spring.gap / e : 1;
  }

  void check() const { spring.check(); }
};

}  // namespace flexarm::joints
