#include "flexarm/simulation/sampled_run.hpp"

#include <algorithm>

#include "flexarm/errors.hpp"
#include "flexarm/simulation/consistent_start.hpp"

namespace flexarm::simulation {

std::vector<int> scalar_origins(const System& held, const System& system) {
  std::vector<int> origin(system.n_scalars(), -1);
  for (std::size_t j = 0; j < system.joints().size(); ++j) {
    const auto &from = held.joints()[j], &to = system.joints()[j];
    if (to.phi < 0) continue;
    origin[to.phi] = from.phi;
    if (to.theta == to.phi) continue;
    // ψ and what stands behind each stage follow one another up to θ.
    const bool sprung = system.drives()[j] != assembly::DriveKind::link_angle;
    const auto stages = static_cast<int>(system.arm().joints[j].drive_train.stages.size());
    const int behind = (sprung ? stages : 0) + (to.psi == to.phi ? 0 : 1);
    for (int k = 0; k < behind; ++k) origin[to.theta - k] = from.theta - k;
  }
  for (std::size_t k = 0; k < system.hinges().size(); ++k) {
    origin[system.hinges()[k].theta] = held.hinges()[k].theta;
  }
  for (std::size_t k = 0; k < system.superelements().size(); ++k) {
    const auto &from = held.superelements()[k], &to = system.superelements()[k];
    for (int mode = 0; mode < to.n_modes(); ++mode) origin[to.mode(mode)] = from.mode(mode);
  }
  return origin;
}

Equilibrium released(const System& held, const Equilibrium& equilibrium, const System& system) {
  Equilibrium result = equilibrium;
  State& state = result.state;
  state.s = Eigen::VectorXd::Zero(system.n_scalars());
  const std::vector<int> origin = scalar_origins(held, system);
  for (int k = 0; k < system.n_scalars(); ++k) {
    if (origin[k] >= 0) state.s[k] = equilibrium.state.s[origin[k]];
  }
  system.remember(state);
  return result;
}

SampledRun::SampledRun(const System& system, const Equilibrium& equilibrium,
                       std::vector<PiecewisePolynomial> drives, const TransientOptions& options)
    : system_(system),
      options_(options),
      state_(equilibrium.state),
      start_(equilibrium),
      n_steps_(number_of_steps(system.joints().size(), drives, options)),
      stepper_(system, integrators::HhtCoefficients::from_alpha(options.alpha), equilibrium.loads,
               {.tolerance = options.tolerance}),
      drive_(drives_of_joints(system, equilibrium.state, std::move(drives))),
      torques_(Eigen::VectorXd::Zero(system.n_scalars())),
      recorder_(system, options, n_steps_ + 1, run_) {
  state_.t = state_.start = options.start;
  recorder_.record(0, state_, equilibrium.loads);
}

void SampledRun::observe(RunObserverIn<3> observer) {
  observer_ = std::move(observer);
  stepper_.observe_with(observer_.step);
  observer_.record(k_, state_, stepper_.loads());
}

void SampledRun::hold(const Eigen::VectorXd& motor_torque) {
  if (motor_torque.size() != static_cast<Eigen::Index>(system_.joints().size())) {
    throw InvalidParameter("one motor torque for each of the " + std::to_string(system_.joints().size()) +
                           " joints is needed, got " + std::to_string(motor_torque.size()));
  }
  if (!motor_torque.allFinite()) throw InvalidParameter("motor torques must be finite");
  for (std::size_t j = 0; j < system_.joints().size(); ++j) {
    if (system_.drives()[j] == assembly::DriveKind::torque) {
      torques_[system_.joints()[j].phi] = motor_torque[static_cast<Eigen::Index>(j)];
    }
  }
}

void SampledRun::torques_at(double t, integrators::DriveValues& values) {
  drive_(t, values);
  for (std::size_t j = 0; j < system_.joints().size(); ++j) {
    if (system_.drives()[j] != assembly::DriveKind::torque) continue;
    const int phi = system_.joints()[j].phi;
    values.torques[phi] = torques_[phi];
  }
}

const Equilibrium& SampledRun::let_go(const Eigen::VectorXd& motor_torque) {
  if (!held_) return start_;
  held_ = false;
  hold(motor_torque);
  start_ = consistent_start(
      system_, {state_, start_.loads},
      [this](double t, integrators::DriveValues& values) { torques_at(t, values); }, options_.start);
  state_ = start_.state;
  state_.t = state_.start = options_.start;
  recorder_.record(0, state_, start_.loads);
  return start_;
}

void SampledRun::advance(const Eigen::VectorXd& motor_torque, int n_steps) {
  let_go(motor_torque);
  hold(motor_torque);
  const auto drives = [this](double t, integrators::DriveValues& values) { torques_at(t, values); };
  for (const Eigen::Index last = std::min(k_ + n_steps, n_steps_); k_ < last;) {
    stepper_.advance(state_, options_.step, drives);
    state_.t = options_.start + static_cast<double>(++k_) * options_.step;  // no drift from adding up
    system_.closures().check(state_.frames, system_.reach(), state_.t);
    recorder_.record(k_, state_, stepper_.loads());
    if (observer_.record) observer_.record(k_, state_, stepper_.loads());
  }
}

Transient SampledRun::result() const {
  Transient run = run_;
  run.finish(k_ + 1);
  run.statistics = stepper_.statistics();
  run.final_state = state_;
  return run;
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
