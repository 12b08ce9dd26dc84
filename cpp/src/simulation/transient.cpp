#include "flexarm/simulation/transient.hpp"

#include <chrono>
#include <cmath>

#include "flexarm/errors.hpp"
#include "flexarm/simulation/recorder.hpp"

namespace flexarm::simulation {
namespace {

using assembly::DriveKind;
using Clock = std::chrono::steady_clock;

/// Steps between two looks at the clock; the callback itself comes ten times a second or more often.
constexpr long steps_between_looks = 32;
constexpr double seconds_between_calls = 0.02;

}  // namespace

void Transient::finish(Eigen::Index n) {
  time.conservativeResize(n);
  for (auto* m : {&position, &velocity, &orientation, &angular_rate, &joint_angle, &joint_rate, &drive_angle,
                  &drive_rate, &joint_torque, &motor_torque, &section_forces, &base_wrench}) {
    if (m->cols() > 0) m->conservativeResize(Eigen::NoChange, n);
  }
  for (auto* v : {&kinetic, &elastic, &gravity, &damped, &work}) {
    if (v->size() > 0) v->conservativeResize(n);
  }
}

solvers::Drives drives_of_joints(const System& system, const State& state,
                                 std::vector<PiecewisePolynomial> drives) {
  struct Driven {
    int phi;
    DriveKind kind;
    PiecewisePolynomial value;
    const joints::Transmission* backwards;  // the drive prescribes ψ(φ)
  };
  std::vector<Driven> driven;
  for (std::size_t j = 0; j < system.joints().size(); ++j) {
    const int phi = system.joints()[j].phi;
    const DriveKind kind = system.drives()[j];
    if (phi < 0 || kind == DriveKind::free) continue;
    driven.push_back(
        {phi, kind,
         kind == DriveKind::locked ? PiecewisePolynomial::constant(state.s[phi]) : std::move(drives[j]),
         kind == DriveKind::link_angle ? system.transmission(static_cast<int>(j)) : nullptr});
  }
  const int base = system.pedestal().theta;
  const model::Pedestal pedestal = system.arm().pedestal.value_or(model::Pedestal{});
  return [driven = std::move(driven), base, pedestal](double t, solvers::DriveValues& values) {
    if (base >= 0) values.torques[base] = pedestal.moment(t);
    for (const Driven& d : driven) {
      auto [value, first, second] = d.value(t);
      if (d.backwards != nullptr) {  // φ = ψ⁻¹(θ), ψ' φ' = θ', ψ' φ'' + ψ'' φ'² = θ''
        value = d.backwards->inverse(value);
        const auto psi = (*d.backwards)(value);
        first /= psi.first;
        second = (second - psi.second * first * first) / psi.first;
      }
      if (d.kind == DriveKind::torque) {
        values.torques[d.phi] = value;
      } else {
        values.s[d.phi] = value;
        values.v[d.phi] = first;
        values.v_dot[d.phi] = second;
      }
    }
  };
}

Eigen::Index number_of_steps(const System& system, const std::vector<PiecewisePolynomial>& drives,
                             const TransientOptions& options) {
  if (!(options.step > 0))
    throw InvalidParameter("step must be positive, got " + std::to_string(options.step) + " s");
  if (!(options.end > options.start)) {
    throw InvalidParameter("the end of a run must lie after its start " + std::to_string(options.start) +
                           " s, got " + std::to_string(options.end) + " s");
  }
  if (drives.size() != system.joints().size()) {
    throw InvalidParameter("one drive for each of the " + std::to_string(system.joints().size()) +
                           " joints is needed, got " + std::to_string(drives.size()));
  }
  return static_cast<Eigen::Index>(std::ceil((options.end - options.start) / options.step - 1e-9));
}

Transient simulate(const System& system, const Equilibrium& equilibrium,
                   const std::vector<PiecewisePolynomial>& drives, const TransientOptions& options,
                   const Progress& progress, const Companion& companion) {
  const Eigen::Index n_steps = number_of_steps(system, drives, options);
  Transient run;
  Recorder recorder(system, options, n_steps + 1, run);
  State state = equilibrium.state;
  state.t = state.start = options.start;
  const solvers::Drives drive = drives_of_joints(system, state, drives);
  solvers::HhtStepper stepper(system, solvers::HhtCoefficients::from_alpha(options.alpha), equilibrium.loads,
                              {.tolerance = options.tolerance});
  stepper.follow_with(companion.step);
  const auto record = [&](Eigen::Index k, const Loads& loads) {
    recorder.record(k, state, loads);
    if (companion.record) companion.record(k, state, loads);
  };
  const auto began = Clock::now();
  auto called = began;
  const auto seconds_since = [](Clock::time_point t) {
    return std::chrono::duration<double>(Clock::now() - t).count();
  };
  record(0, equilibrium.loads);
  for (Eigen::Index k = 1; k <= n_steps; ++k) {
    stepper.advance(state, options.step, drive);
    state.t = options.start + static_cast<double>(k) * options.step;  // no drift from adding up
    record(k, stepper.loads());
    if (progress && k % steps_between_looks == 0 && seconds_since(called) > seconds_between_calls) {
      called = Clock::now();
      if (!progress(static_cast<double>(k) / static_cast<double>(n_steps))) {
        run.cancelled = true;
        run.finish(k + 1);
        break;
      }
    }
  }
  run.seconds = seconds_since(began);
  run.statistics = stepper.statistics();
  run.final_state = std::move(state);
  return run;
}

}  // namespace flexarm::simulation
