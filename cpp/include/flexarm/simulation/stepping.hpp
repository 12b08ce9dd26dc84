/// @file
/// One step at a time, for a caller who decides from step to step what joints are told.
///
/// A step is a function: the same moment and inputs give the same result to the last bit, whatever was
/// stepped before and in whichever process. So a moment holds, beside the state, what the solver carries from
/// step to step (HhtMemory): where its matrix was factored, and how fast it contracted.
#pragma once

#include "flexarm/integrators/hht.hpp"
#include "flexarm/simulation/statics.hpp"

namespace flexarm::simulation {

/// An instant to go on from: a value, copied and stored freely.
struct Moment {
  State state;
  integrators::HhtMemory memory;
  long steps = 0;  ///< since t = 0
};

/// What a joint is told for a step: the torque held over it [N m], or the angle at its end [rad].
struct JointInput {
  double value = 0;
  /// Rate and acceleration of an angle at the end of the step; left out, they follow from the angles
  /// (prescribed_angle.hpp).
  bool has_rates = false;
  double rate = 0, acceleration = 0;
};

class Stepping {
 public:
  /// @throws InvalidParameter if step or alpha is out of range.
  Stepping(const System& system, double step, double alpha);

  Moment start(const Equilibrium& equilibrium) const { return {equilibrium.state, {}, 0}; }

  /// The next moment.
  /// @param inputs one a joint; not read for free and locked joints. @param points loads held over the step.
  /// @throws NotConverged, InvalidParameter
  Moment advance(const Moment& from, const std::vector<JointInput>& inputs,
                 const std::vector<assembly::PointLoad>& points);

  const System& system() const { return system_; }
  const integrators::HhtStatistics& statistics() const { return stepper_.statistics(); }

 private:
  const System& system_;
  double step_;
  integrators::HhtStepper stepper_;
};

}  // namespace flexarm::simulation
