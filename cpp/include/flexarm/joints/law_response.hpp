/// @file
/// What passes between a joint law and the solvers: its memory and its answer.
#pragma once

namespace flexarm::joints {

/// Where statics holds the teeth of a reducer with backlash while it looks for the side they lie on; `free`
/// everywhere else.
enum class Flank { free, closed, positive, negative };

/// What a law remembers from the last accepted instant.
struct LawMemory {
  double x = 0;  ///< deflection there
  double z = 0;  ///< internal state there, in the law's own unit
  Flank flank = Flank::free;
};

/// The state of which a law is a function; joints/drive_train.hpp has the angles, `across` is that of the
/// other slide of a pin.
enum class Of { angle, rate, torque, motor_angle, across };

/// A second coordinate y of which a law may be a function, its rate, and the time [s].
struct LawArgument {
  double value = 0, rate = 0, time = 0;
};

/// Answer of a law at a trial deflection x, rate x', with the memory (x₀, z₀).
struct LawResponse {
  double force = 0;      ///< Q: what the law puts against the deflection
  double stiffness = 0;  ///< ∂Q/∂x
  double damping = 0;    ///< ∂Q/∂x'
  double energy = 0;     ///< stored [J]
  double loss = 0;       ///< the part of Q that dissipates
  double z = 0;          ///< internal state at the trial

  // What the past does to the force, and all that makes z: zero for laws without memory.
  double force_by_x0 = 0, force_by_z0 = 0;  ///< ∂Q/∂x₀, ∂Q/∂z₀
  double z_by_x = 0, z_by_rate = 0;         ///< ∂z/∂x, ∂z/∂x'
  double z_by_x0 = 0, z_by_z0 = 0;          ///< ∂z/∂x₀, ∂z/∂z₀

  double force_by_y = 0, force_by_y_rate = 0;  ///< ∂Q/∂y, ∂Q/∂y' where Q has a second argument
};

}  // namespace flexarm::joints
