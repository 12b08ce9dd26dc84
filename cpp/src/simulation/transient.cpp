#include "flexarm/simulation/transient.hpp"

#include <chrono>
#include <cmath>

#include "flexarm/errors.hpp"
#include "flexarm/simulation/energy.hpp"
#include "flexarm/simulation/reactions.hpp"

namespace flexarm::simulation {
namespace {

using assembly::DriveKind;
using Clock = std::chrono::steady_clock;

/// Steps between two looks at the clock; the callback itself comes ten times a second or more often.
constexpr long steps_between_looks = 32;
constexpr double seconds_between_calls = 0.02;

/// Writes what the options ask for, and sums losses and work from step to step.
class Recorder {
 public:
  Recorder(const System& system, const TransientOptions& options, Eigen::Index n, Transient& out)
      : system_(system), options_(options), out_(out) {
    const auto p = static_cast<Eigen::Index>(system.points().size());
    const auto j = static_cast<Eigen::Index>(system.joints().size());
    const auto l = static_cast<Eigen::Index>(system.meshes().size());
    out.time.resize(n);
    if (options.record_points) resize(n, {{&out.position, 3 * p}, {&out.velocity, 3 * p}});
    if (options.record_rotations) resize(n, {{&out.orientation, 4 * p}, {&out.angular_rate, 3 * p}});
    if (options.record_joints) {
      resize(n, {{&out.joint_angle, j}, {&out.joint_rate, j}, {&out.drive_angle, j}, {&out.drive_rate, j}});
      resize(n, {{&out.joint_torque, j}, {&out.motor_torque, j}});
    }
    if (options.record_energies) {
      for (auto* column : {&out.kinetic, &out.elastic, &out.gravity, &out.damped, &out.work})
        column->setZero(n);
    }
    if (options.record_forces) resize(n, {{&out.section_forces, 12 * l}, {&out.base_wrench, 6}});
  }

  void record(Eigen::Index k, const State& state, const Loads& loads) {
    out_.time[k] = state.t;
    if (options_.record_points || options_.record_rotations) points(k, state);
    if (options_.record_joints) joints(k, state);
    if (options_.record_energies) energy(k, state, loads);
    if (options_.record_forces) {
      for (int link = 0; link < static_cast<int>(system_.meshes().size()); ++link) {
        const SectionForces f = section_forces(system_, state, loads, link);
        out_.section_forces.col(k).segment<12>(12 * link) << f.start, f.end;
      }
      out_.base_wrench.col(k) = base_wrench(system_, state);
    }
  }

 private:
  static void resize(Eigen::Index n,
                     std::initializer_list<std::pair<Eigen::MatrixXd*, Eigen::Index>> columns) {
    for (auto [matrix, rows] : columns) matrix->resize(rows, n);
  }

  void points(Eigen::Index k, const State& state) {
    for (int p = 0; p < static_cast<int>(system_.points().size()); ++p) {
      const geometry::Frame H = system_.point_frame(state, p);
      const geometry::Vector6d v = system_.point_velocity(state, p);
      if (options_.record_points) {
        out_.position.col(k).segment<3>(3 * p) = H.x;
        out_.velocity.col(k).segment<3>(3 * p) = H.R * v.head<3>();
      }
      if (options_.record_rotations) {
        out_.orientation.col(k).segment<4>(4 * p) = Eigen::Quaterniond(H.R).normalized().coeffs();
        out_.angular_rate.col(k).segment<3>(3 * p) = v.tail<3>();
      }
    }
  }

  void joints(Eigen::Index k, const State& state) {
    const Eigen::VectorXd motor = motor_torques(system_, state, true);
    for (int j = 0; j < static_cast<int>(system_.joints().size()); ++j) {
      const auto [theta, phi] = system_.joints()[j];
      const auto rate = [&](int s) { return s < 0 ? 0.0 : state.v[system_.scalar_offset() + s]; };
      const auto angle = [&](int s) { return s < 0 ? 0.0 : state.s[s]; };
      out_.joint_angle(j, k) = angle(theta);
      out_.joint_rate(j, k) = rate(theta);
      out_.drive_angle(j, k) = angle(phi);
      out_.drive_rate(j, k) = rate(phi);
      out_.joint_torque(j, k) = joint_torque(system_, state, j);
      out_.motor_torque(j, k) = motor[j];
    }
  }

  /// Losses and work between two instants by the trapezoidal rule, over time or over the path.
  void energy(Eigen::Index k, const State& state, const Loads& loads) {
    const Energies E = energies(system_, state, loads);
    out_.kinetic[k] = E.kinetic;
    out_.elastic[k] = E.elastic;
    out_.gravity[k] = E.gravity;
    Instant now{beam_dissipation(system_, state),
                load_power(system_, state, loads),
                law_losses(system_, state),
                motor_torques(system_, state, true),
                state.s,
                state.t};
    if (k > 0) {
      const double h = now.t - last_.t;
      double damped = 0.5 * h * (now.dissipation + last_.dissipation);
      double work = 0.5 * h * (now.power + last_.power);
      for (std::size_t i = 0; i < system_.laws().size(); ++i) {
        const double dx =
            system_.deflection(system_.laws()[i], now.s) - system_.deflection(system_.laws()[i], last_.s);
        damped += 0.5 * dx * (now.loss[i] + last_.loss[i]);
      }
      for (std::size_t j = 0; j < system_.joints().size(); ++j) {
        const int phi = system_.joints()[j].phi;
        if (phi >= 0) work += 0.5 * (now.s[phi] - last_.s[phi]) * (now.motor[j] + last_.motor[j]);
      }
      out_.damped[k] = out_.damped[k - 1] + damped;
      out_.work[k] = out_.work[k - 1] + work;
    }
    last_ = std::move(now);
  }

  struct Instant {
    double dissipation, power;
    Eigen::VectorXd loss, motor, s;
    double t;
  };

  const System& system_;
  const TransientOptions& options_;
  Transient& out_;
  Instant last_;
};

/// Keeps the first n columns.
void truncate(Transient& run, Eigen::Index n) {
  run.time.conservativeResize(n);
  for (auto* m : {&run.position, &run.velocity, &run.orientation, &run.angular_rate, &run.joint_angle,
                  &run.joint_rate, &run.drive_angle, &run.drive_rate, &run.joint_torque, &run.motor_torque,
                  &run.section_forces, &run.base_wrench}) {
    if (m->cols() > 0) m->conservativeResize(Eigen::NoChange, n);
  }
  for (auto* v : {&run.kinetic, &run.elastic, &run.gravity, &run.damped, &run.work}) {
    if (v->size() > 0) v->conservativeResize(n);
  }
}

}  // namespace

solvers::Drives drives_of_joints(const System& system, const State& state,
                                 std::vector<PiecewisePolynomial> drives) {
  struct Driven {
    int phi;
    DriveKind kind;
    PiecewisePolynomial value;
  };
  std::vector<Driven> driven;
  for (std::size_t j = 0; j < system.joints().size(); ++j) {
    const int phi = system.joints()[j].phi;
    const DriveKind kind = system.drives()[j];
    if (phi < 0 || kind == DriveKind::free) continue;
    driven.push_back(
        {phi, kind,
         kind == DriveKind::locked ? PiecewisePolynomial::constant(state.s[phi]) : std::move(drives[j])});
  }
  return [driven = std::move(driven)](double t, solvers::DriveValues& values) {
    for (const Driven& d : driven) {
      const auto [value, first, second] = d.value(t);
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

Transient simulate(const System& system, const Equilibrium& equilibrium,
                   const std::vector<PiecewisePolynomial>& drives, const TransientOptions& options,
                   const Progress& progress) {
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
  const auto n_steps =
      static_cast<Eigen::Index>(std::ceil((options.end - options.start) / options.step - 1e-9));
  Transient run;
  Recorder recorder(system, options, n_steps + 1, run);
  State state = equilibrium.state;
  state.t = options.start;
  const solvers::Drives drive = drives_of_joints(system, state, drives);
  solvers::HhtStepper stepper(system, solvers::HhtCoefficients::from_alpha(options.alpha), equilibrium.loads,
                              {.tolerance = options.tolerance});
  const auto began = Clock::now();
  auto called = began;
  const auto seconds_since = [](Clock::time_point t) {
    return std::chrono::duration<double>(Clock::now() - t).count();
  };
  recorder.record(0, state, equilibrium.loads);
  for (Eigen::Index k = 1; k <= n_steps; ++k) {
    stepper.advance(state, options.step, drive);
    state.t = options.start + static_cast<double>(k) * options.step;  // no drift from adding up
    recorder.record(k, state, stepper.loads());
    if (progress && k % steps_between_looks == 0 && seconds_since(called) > seconds_between_calls) {
      called = Clock::now();
      if (!progress(static_cast<double>(k) / static_cast<double>(n_steps))) {
        run.cancelled = true;
        truncate(run, k + 1);
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
