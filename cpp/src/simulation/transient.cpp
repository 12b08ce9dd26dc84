#include "flexarm/simulation/transient.hpp"

#include <chrono>
#include <cmath>

#include "flexarm/errors.hpp"
#include "flexarm/simulation/consistent_start.hpp"
#include "flexarm/simulation/recorder.hpp"

namespace flexarm::simulation {
namespace {

using assembly::DriveKind;
using Clock = std::chrono::steady_clock;

/// Steps between two looks at the clock; the callback itself comes ten times a second or more often.
constexpr long steps_between_looks = 32;
/// More would not fit into any memory, nor their number into every index.
constexpr long most_steps = 1'000'000'000;

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

template <int D>
integrators::Drives drives_of_joints(const assembly::SystemIn<D>& system, const assembly::StateIn<D>& state,
                                     std::vector<PiecewisePolynomial> drives) {
  struct Driven {
    int phi;
    DriveKind kind;
    PiecewisePolynomial value;
    const joints::Transmission* backwards;  // the drive prescribes ψ(φ)
    std::size_t piece;                      // where t was last: times of a run hardly ever go back
  };
  std::vector<Driven> driven;
  for (std::size_t j = 0; j < system.joints().size(); ++j) {
    const int phi = system.joints()[j].phi;
    const DriveKind kind = system.drives()[j];
    if (phi < 0 || kind == DriveKind::free) continue;
    driven.push_back(
        {phi, kind,
         kind == DriveKind::locked ? PiecewisePolynomial::constant(state.s[phi]) : std::move(drives[j]),
         kind == DriveKind::link_angle ? system.transmission(static_cast<int>(j)) : nullptr, 0});
  }
  return [driven = std::move(driven), pedestal = system.pedestal()](
             double t, integrators::DriveValues& values) mutable {
    pedestal.shake(t, values.torques);
    for (Driven& d : driven) {
      auto [value, first, second] = d.value(t, d.piece);
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

template integrators::Drives drives_of_joints<2>(const assembly::SystemIn<2>&, const assembly::StateIn<2>&,
                                                 std::vector<PiecewisePolynomial>);
template integrators::Drives drives_of_joints<3>(const assembly::SystemIn<3>&, const assembly::StateIn<3>&,
                                                 std::vector<PiecewisePolynomial>);

Eigen::Index number_of_steps(std::size_t n_joints, const std::vector<PiecewisePolynomial>& drives,
                             const TransientOptions& options) {
  integrators::check_step(options.step);
  if (!(options.end > options.start && std::isfinite(options.end - options.start))) {
    throw InvalidParameter("the end of a run must lie after its start " + std::to_string(options.start) +
                           " s, got " + std::to_string(options.end) + " s");
  }
  if (drives.size() != n_joints) {
    throw InvalidParameter("one drive for each of the " + std::to_string(n_joints) +
                           " joints is needed, got " + std::to_string(drives.size()));
  }
  const double n = std::ceil((options.end - options.start) / options.step - 1e-9);
  if (!(n <= most_steps)) {
    throw InvalidParameter("a run may have " + std::to_string(most_steps) + " steps, got " +
                           std::to_string(n));
  }
  return static_cast<Eigen::Index>(n);
}

namespace {

template <int D>
using RecordIn =
    std::function<void(Eigen::Index k, const assembly::StateIn<D>& state, const assembly::LoadsIn<D>& loads)>;

/// The steps of a run. @return the state at its end
template <int D>
assembly::StateIn<D> walk(const assembly::SystemIn<D>& system, assembly::StateIn<D> state,
                          const assembly::LoadsIn<D>& loads, const integrators::Drives& drive,
                          Eigen::Index n_steps, const TransientOptions& options, const Progress& progress,
                          const integrators::StepObserverIn<D>& observer, const RecordIn<D>& record,
                          Transient& run) {
  integrators::HhtStepperIn<D> stepper(
      system, integrators::HhtCoefficients::from_alpha(options.alpha), loads,
      {.tolerance = options.tolerance, .condense = !options.record_forces && !observer});
  stepper.observe_with(observer);
  const auto began = Clock::now();
  auto called = began;
  const auto seconds_since = [](Clock::time_point t) {
    return std::chrono::duration<double>(Clock::now() - t).count();
  };
  state.t = state.start = options.start;
  record(0, state, loads);
  for (Eigen::Index k = 1; k <= n_steps; ++k) {
    stepper.advance(state, options.step, drive);
    system.closures().check(state.frames, system.reach(), state.t);
    state.t = options.start + static_cast<double>(k) * options.step;  // no drift from adding up
    record(k, state, stepper.loads());
    if (progress && k % steps_between_looks == 0 && seconds_since(called) > seconds_between_calls) {
      called = Clock::now();
      if (!progress(static_cast<double>(k) / static_cast<double>(n_steps))) {
        run.cancelled = true;
        run.finish(k + 1);
        break;
      }
    }
  }
  stepper.recover_multipliers(state);
  run.seconds = seconds_since(began);
  run.statistics = stepper.statistics();
  run.dimension = D;
  return state;
}

/// The plane of the motion; none if the arm leaves it or nobody looks for it.
assembly::PlanarSystem::Attempt plane_of(const System& system, const Equilibrium& equilibrium,
                                         const TransientOptions& options) {
  if (options.dimension == Dimension::space) return {};
  auto attempt = assembly::PlanarSystem::about(system, equilibrium.state, equilibrium.loads);
  if (!attempt.system && options.dimension == Dimension::plane) {
    throw InvalidParameter("the arm does not move in a plane: " + attempt.obstacle);
  }
  return attempt;
}

}  // namespace

Transient simulate_in_space(const System& system, const Equilibrium& equilibrium,
                            const std::vector<PiecewisePolynomial>& drives, const TransientOptions& options,
                            const Progress& progress, const RunObserverIn<3>& observer) {
  const Eigen::Index n_steps = number_of_steps(system.joints().size(), drives, options);
  Transient run;
  RecorderIn<3> recorder(system, options, n_steps + 1, run);
  const auto record = [&](Eigen::Index k, const State& state, const Loads& loads) {
    recorder.record(k, state, loads);
    if (observer.record) observer.record(k, state, loads);
  };
  run.final_state = walk<3>(system, equilibrium.state, equilibrium.loads,
                            drives_of_joints<3>(system, equilibrium.state, drives), n_steps, options,
                            progress, observer.step, record, run);
  return run;
}

Transient simulate_in_plane(const assembly::PlanarSystem& plane, const Equilibrium& equilibrium,
                            const std::vector<PiecewisePolynomial>& drives, const TransientOptions& options,
                            const Progress& progress, const RunObserverIn<2>& observer) {
  const Eigen::Index n_steps = number_of_steps(plane.joints().size(), drives, options);
  Transient run;
  RecorderIn<2> recorder(plane, options, n_steps + 1, run, InSpace<2>(plane));
  const auto record = [&](Eigen::Index k, const assembly::StateIn<2>& state,
                          const assembly::LoadsIn<2>& loads) {
    recorder.record(k, state, loads);
    if (observer.record) observer.record(k, state, loads);
  };
  const auto state = plane.part(equilibrium.state);
  const auto end =
      walk<2>(plane, state, plane.part(equilibrium.loads), drives_of_joints<2>(plane, state, drives), n_steps,
              options, progress, observer.step, record, run);
  run.final_state = plane.embed(end, equilibrium.state);
  return run;
}

Transient simulate(const System& system, const Equilibrium& equilibrium,
                   const std::vector<PiecewisePolynomial>& drives, const TransientOptions& options,
                   const Progress& progress) {
  const Equilibrium start = consistent_start(
      system, equilibrium, drives_of_joints<3>(system, equilibrium.state, drives), options.start);
  if (const auto plane = plane_of(system, start, options).system) {
    return simulate_in_plane(*plane, start, drives, options, progress);
  }
  return simulate_in_space(system, start, drives, options, progress);
}

}  // namespace flexarm::simulation
