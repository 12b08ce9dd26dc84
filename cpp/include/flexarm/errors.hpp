/// @file
/// The two ways a computation can fail: on what it was given, or on the way to its answer.
#pragma once
#include <stdexcept>
#include <string>

namespace flexarm {

/// A value that the model cannot take; the message names object, requirement, value and unit.
/// Python: flexarm.errors.InvalidParameter, a ValueError.
struct InvalidParameter : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Newton's iteration did not reach its tolerance; the message names step, time and norms.
/// Python: flexarm.errors.NotConverged, a RuntimeError.
struct NotConverged : std::runtime_error {
  NotConverged(const std::string& message, double at_time, int at_iteration, double left_over)
      : std::runtime_error(message), time(at_time), iteration(at_iteration), residual(left_over) {}

  double time;      // of the end of the step [s]; 0 in statics
  int iteration;    // the last one made
  double residual;  // norm left over, in the unit that the message states
};

}  // namespace flexarm
