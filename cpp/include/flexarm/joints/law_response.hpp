/// @file
/// What passes between a joint law and the solvers: its memory and its answer.
#pragma once

namespace flexarm::joints {

/// What a law remembers from the last accepted instant.
struct LawMemory {
  double x = 0;  ///< deflection there
  double z = 0;  ///< internal state there [-]
};

/// Answer of a law at a trial deflection.
struct LawResponse {
  double force = 0;      ///< Q: what the law puts against the deflection
  double stiffness = 0;  ///< ∂Q/∂x
  double damping = 0;    ///< ∂Q/∂x'
  double energy = 0;     ///< stored [J]
  double loss = 0;       ///< the part of Q that dissipates
  double z = 0;          ///< internal state at the trial
};

}  // namespace flexarm::joints
