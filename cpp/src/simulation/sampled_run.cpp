#include "flexarm/simulation/sampled_run.hpp"

#include "flexarm/errors.hpp"

namespace flexarm::simulation {

SampledRun::SampledRun(const System& system, const Equilibrium& equilibrium, double step, double alpha)
    : system_(system),
      state_(equilibrium.state),
      step_(step),
      stepper_(system, solvers::HhtCoefficients::from_alpha(alpha), equilibrium.loads) {
  if (!(step > 0)) throw InvalidParameter("step must be positive, got " + std::to_string(step) + " s");
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(system.n_scalars());
  held_ = {state_.s, zero, zero, zero};
}

void SampledRun::advance(const Eigen::VectorXd& motor_torque, int n_steps) {
  if (motor_torque.size() != static_cast<Eigen::Index>(system_.joints().size())) {
    throw InvalidParameter("one motor torque for each of the " + std::to_string(system_.joints().size()) +
                           " joints is needed, got " + std::to_string(motor_torque.size()));
  }
  for (std::size_t j = 0; j < system_.joints().size(); ++j) {
    if (system_.drives()[j] == assembly::DriveKind::torque) {
      held_.torques[system_.joints()[j].phi] = motor_torque[static_cast<Eigen::Index>(j)];
    }
  }
  const auto hold = [this](double, solvers::DriveValues& values) { values = held_; };
  for (int k = 0; k < n_steps; ++k) stepper_.advance(state_, step_, hold);
}

Eigen::VectorXd SampledRun::of_joints(const Eigen::Ref<const Eigen::VectorXd>& scalars, bool theta) const {
  Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(system_.joints().size()));
  for (Eigen::Index j = 0; j < values.size(); ++j) {
    const auto& at = system_.joints()[static_cast<std::size_t>(j)];
    if (at.phi >= 0) values[j] = scalars[theta ? at.theta : at.phi];
  }
  return values;
}

Eigen::VectorXd SampledRun::drive_angles() const { return of_joints(state_.s, false); }
Eigen::VectorXd SampledRun::joint_angles() const { return of_joints(state_.s, true); }
Eigen::VectorXd SampledRun::drive_rates() const {
  return of_joints(state_.v.tail(system_.n_scalars()), false);
}
Eigen::VectorXd SampledRun::joint_rates() const {
  return of_joints(state_.v.tail(system_.n_scalars()), true);
}

Eigen::Vector3d SampledRun::point_position(int point) const { return system_.point_frame(state_, point).x; }

Eigen::Vector3d SampledRun::point_velocity(int point) const {
  return system_.point_frame(state_, point).R * system_.point_velocity(state_, point).head<3>();
}

}  // namespace flexarm::simulation
