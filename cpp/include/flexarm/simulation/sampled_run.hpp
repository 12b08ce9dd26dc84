/// @file
/// A run under a sampled controller: motor torques held from one sample to the next, the arm looked at in
/// between.
#pragma once

#include "flexarm/simulation/statics.hpp"
#include "flexarm/solvers/hht.hpp"

namespace flexarm::simulation {

class SampledRun {
 public:
  /// Starts at rest in the equilibrium, whose motors hold the arm. @param step of the integration [s]
  SampledRun(const System& system, const Equilibrium& equilibrium, double step, double alpha);

  /// `n_steps` steps with these motor torques, one a joint, output-referred [N m]; joints driven otherwise
  /// stay.
  /// @throws NotConverged
  void advance(const Eigen::VectorXd& motor_torque, int n_steps);

  const State& state() const { return state_; }
  double time() const { return state_.t; }
  Eigen::VectorXd drive_angles() const;  ///< φ of every joint [rad]
  Eigen::VectorXd drive_rates() const;
  Eigen::VectorXd joint_angles() const;  ///< θ
  Eigen::VectorXd joint_rates() const;
  Eigen::Vector3d point_position(int point) const;  ///< base axes [m]
  Eigen::Vector3d point_velocity(int point) const;  ///< base axes [m/s]
  const solvers::HhtStatistics& statistics() const { return stepper_.statistics(); }

 private:
  Eigen::VectorXd of_joints(const Eigen::Ref<const Eigen::VectorXd>& scalars, bool theta) const;

  const System& system_;
  State state_;
  double step_;
  solvers::HhtStepper stepper_;
  solvers::DriveValues held_;
};

}  // namespace flexarm::simulation
