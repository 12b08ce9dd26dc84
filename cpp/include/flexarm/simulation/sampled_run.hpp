/// @file
/// A run under a sampled controller: motor torques held from one sample to the next, the arm looked at in
/// between. Instants are recorded as in a transient.
#pragma once

#include "flexarm/simulation/recorder.hpp"
#include "flexarm/simulation/transient.hpp"

namespace flexarm::simulation {

/// For each scalar coordinate of an arm the one of the same arm with its motors held; −1 where there is none.
std::vector<int> scalar_origins(const System& held, const System& system);

/// The equilibrium of an arm whose motors are held, as one of the same arm with some of them let go; what
/// the motors gave is not part of it.
Equilibrium released(const System& held, const Equilibrium& equilibrium, const System& system);

class SampledRun {
 public:
  /// Starts at rest in the equilibrium, whose motors hold the arm.
  /// @param drives one a joint, as in `simulate`; those of motors with a torque are not read.
  SampledRun(const System& system, const Equilibrium& equilibrium, std::vector<PiecewisePolynomial> drives,
             const TransientOptions& options);
  SampledRun(const SampledRun&) = delete;  // the recorder writes into this run's columns
  SampledRun& operator=(const SampledRun&) = delete;

  /// Lets somebody walk along from this instant on, which is recorded first.
  void observe(RunObserverIn<3> observer);

  /// `n_steps` steps with these motor torques, one a joint, output-referred [N m]; not beyond the end.
  /// @throws NotConverged
  void advance(const Eigen::VectorXd& motor_torque, int n_steps);

  /// Lets the motors go at the start, if they are held yet; the first advance() does it otherwise.
  /// @return the start with the accelerations that these torques give, consistent_start.hpp
  const Equilibrium& let_go(const Eigen::VectorXd& motor_torque);

  const System& system() const { return system_; }
  bool done() const { return k_ >= n_steps_; }
  const State& state() const { return state_; }
  double time() const { return state_.t; }
  Eigen::VectorXd drive_angles() const;  ///< φ of every joint [rad]
  Eigen::VectorXd drive_rates() const;
  Eigen::VectorXd joint_angles() const;  ///< θ
  Eigen::VectorXd joint_rates() const;
  Eigen::Vector3d point_position(int point) const;  ///< base axes [m]
  Eigen::Vector3d point_velocity(int point) const;  ///< base axes [m/s]
  const integrators::HhtStatistics& statistics() const { return stepper_.statistics(); }

  /// What was recorded so far.
  Transient result() const;

 private:
  Eigen::VectorXd of_joints(const Eigen::Ref<const Eigen::VectorXd>& scalars, bool theta) const;
  void hold(const Eigen::VectorXd& motor_torque);
  void torques_at(double t, integrators::DriveValues& values);

  const System& system_;
  TransientOptions options_;
  State state_;
  Equilibrium start_;
  bool held_ = true;
  Eigen::Index n_steps_, k_ = 0;
  integrators::HhtStepper stepper_;
  integrators::Drives drive_;
  Eigen::VectorXd torques_;  // one a scalar coordinate
  Transient run_;
  Recorder recorder_;
  RunObserverIn<3> observer_;
};

}  // namespace flexarm::simulation
