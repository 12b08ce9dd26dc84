/// @file
/// First natural frequency of a chain of beam elements whose first node is clamped and whose last is free.
///
/// A link's damping ratio ζ is that of the link alone in this mode; with damping proportional to stiffness, C
/// = η K,
///
///     η = 2 ζ/ω₁                                                                                    (1)
#pragma once

#include <span>

#include "flexarm/elements/beam.hpp"

namespace flexarm::elements {

/// ω₁ [rad/s] of elements that follow one another, undeformed. The lowest mode, in whichever plane it bends.
double first_clamped_frequency(std::span<const BeamElement> chain);

}  // namespace flexarm::elements
