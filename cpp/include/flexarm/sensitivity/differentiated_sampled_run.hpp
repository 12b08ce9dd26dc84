/// @file
/// A run under a sampled controller together with derivatives with respect to parameters.
///
/// From one sample to the next motor torques τ are held, and so are their derivatives: in between a run is
/// differentiated step by step, sensitivity.hpp. At a sample the caller, who knows the control law, looks at
/// the arm and at its derivatives, and tells τ and
///
///     dτ/dp = ∂τ/∂y dy/dp + ∂τ/∂p                                                                   (1)
///
/// with the readings y of the arm.
#pragma once

#include "flexarm/sensitivity/derivative_recorder.hpp"
#include "flexarm/sensitivity/differentiated_run.hpp"
#include "flexarm/sensitivity/sensitivity.hpp"
#include "flexarm/simulation/sampled_run.hpp"

namespace flexarm::sensitivity {

using assembly::System;
using Eigen::VectorXd;
using simulation::Equilibrium;
using simulation::PiecewisePolynomial;
using simulation::SampledRun;
using simulation::Slopes;
using simulation::StateDerivative;
using simulation::Transient;
using simulation::TransientOptions;
using simulation::Variation;

class DifferentiatedSampledRun {
 public:
  /// As SampledRun; `initial` is the derivative of the equilibrium's state.
  DifferentiatedSampledRun(const System& system, const Equilibrium& equilibrium,
                           std::vector<PiecewisePolynomial> drives, const TransientOptions& options,
                           std::vector<Variation> variations, StateDerivative initial);

  /// As SampledRun::advance, with dτ/dp of (1): one row a joint, one column a parameter.
  /// @throws NotConverged, InvalidParameter
  void advance(const VectorXd& motor_torque, const Slopes& torque_slopes, int n_steps);

  const SampledRun& run() const { return run_; }

  /// Derivatives of what the run shows now: one row a joint or axis, one column a parameter.
  Slopes drive_angle_slopes() const { return of_joints(columns_.drive_angle); }
  Slopes drive_rate_slopes() const { return of_joints(columns_.drive_rate); }
  Slopes joint_angle_slopes() const { return of_joints(columns_.joint_angle); }
  Slopes joint_rate_slopes() const { return of_joints(columns_.joint_rate); }
  Slopes point_position_slopes(int point) const { return now(columns_.position, 3 * point, 3); }

  /// What was recorded so far.
  DifferentiatedRun result() const;

 private:
  Slopes now(const Transient::Matrix& columns, Eigen::Index first, Eigen::Index rows) const;
  Slopes of_joints(const Transient::Matrix& columns) const;

  const System& system_;
  SampledRun run_;
  SensitivitiesIn<3> sensitivities_;
  Transient columns_;  // derivatives
  DerivativeRecorderIn<3> recorder_;
  Eigen::Index k_ = 0;  // instant recorded last
  Slopes torques_;      // one row a scalar coordinate
};

}  // namespace flexarm::sensitivity
