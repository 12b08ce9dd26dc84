/// @file
/// Motion of a prescribed angle that is known at the ends of steps only.
///
/// The new angle s₁ is reached by the Newmark formulas of integrators/hht.hpp, solved for the acceleration,
///
///     a₁ = [(s₁ − s₀ − h s₀')/h² − (½ − β) a₀]/β,   s₁' = s₀' + h [(1 − γ) a₀ + γ a₁]                 (1)
///     s₁'' = (a₁ + α s₀'')/(1 + α)                                                                    (2)
///
/// with α = −1/3, whatever α the arm has: an error of a rate or an acceleration then falls to a half in each
/// step (spectral radius ½), where with α = 0 it would ring for ever. Rates are of order two. Within the step
/// the angle runs along the quintic that has both ends' values and two derivatives.
#pragma once

#include "flexarm/integrators/hht.hpp"

namespace flexarm::simulation {

/// Value and two derivatives.
struct Motion {
  double s = 0, v = 0, v_dot = 0;
};

struct PrescribedAngle {
  Motion motion;
  double a = 0;  ///< algorithmic acceleration

  /// Where (1), (2) take it within h.
  PrescribedAngle reach(double s, double h) const;
  /// Where it is after h if its motion is known there.
  PrescribedAngle follow(const Motion& end) const;
};

/// The quintic from `begin` to `end` at the part x of a step h, 0 to 1.
Motion quintic(const Motion& begin, const Motion& end, double h, double x);

}  // namespace flexarm::simulation
