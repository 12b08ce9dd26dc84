/// @file
/// On which flank the teeth of a reducer with backlash lie at rest.
///
/// Inside its gap next to nothing holds a joint, and Newton's method would run from one flank to the other.
/// Statics therefore closes the gaps first; the sign of each torque then says on which flank its teeth lie,
/// and they are held there, touching from either side, in a second solution. It stands if no flank pulls. A
/// torque that changes its sign on the way has its rest inside the gap (a hanging arm near the vertical);
/// there the law as it is decides, and an arm that falls from there comes to lie on the negative flank, so
/// that the link is ahead of its motor: upright on its ridge, it leans to its positive angles.
#pragma once

#include "flexarm/assembly/system.hpp"

namespace flexarm::simulation {

using assembly::State;
using assembly::System;

bool has_gaps(const System& system);

/// All teeth touch both flanks: the arm without its backlash.
void close_gaps(const System& system, State& state);

/// Teeth on the flanks that the torques of the closed gaps push them against; loose where there is none.
void open_gaps(const System& system, State& state);

/// Lets go of flanks that would have to pull and takes hold of those that loose teeth have passed; where the
/// loose ones are not stable, their joints fall to the negative flank. @return whether anything changed
bool correct_flanks(const System& system, State& state, bool stable);

}  // namespace flexarm::simulation
