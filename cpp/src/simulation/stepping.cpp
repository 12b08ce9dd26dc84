#include "flexarm/simulation/stepping.hpp"

#include "flexarm/errors.hpp"
#include "flexarm/simulation/consistent_start.hpp"
#include "flexarm/simulation/prescribed_angle.hpp"

namespace flexarm::simulation {
namespace {

using assembly::DriveKind;

/// A prescribed coordinate over one step.
struct Path {
  int coordinate;
  PrescribedAngle begin, end;

  Motion at(double h, double x) const { return quintic(begin.motion, end.motion, h, x); }
};

/// The part of a step above which it is over: times are sums.
constexpr double whole = 1 - 1e-9;

/// What the motor does when its link is told its own angle: θ = ψ(φ), θ' = ψ' φ', θ'' = ψ' φ'' + ψ'' φ'².
JointInput through(const joints::Transmission& transmission, const JointInput& told) {
  const double phi = transmission.inverse(told.value);
  const auto psi = transmission(phi);
  const double rate = told.rate / psi.first;
  return {phi, told.has_rates, rate, (told.acceleration - psi.second * rate * rate) / psi.first};
}

std::vector<Path> paths(const System& system, const State& state, const std::vector<JointInput>& inputs,
                        double h) {
  std::vector<Path> found;
  for (std::size_t j = 0; j < inputs.size(); ++j) {
    const int phi = system.joints()[j].phi;
    const DriveKind kind = system.drives()[j];
    if (phi < 0 || kind == DriveKind::torque || kind == DriveKind::free) continue;
    const int row = system.scalar_offset() + phi;
    const PrescribedAngle begin{{state.s[phi], state.v[row], state.v_dot[row]}, state.a[row]};
    const joints::Transmission* transmission =
        kind == DriveKind::link_angle ? system.transmission(static_cast<int>(j)) : nullptr;
    const JointInput told = transmission == nullptr ? inputs[j] : through(*transmission, inputs[j]);
    if (kind == DriveKind::locked) {
      found.push_back({phi, begin, begin.follow({state.s[phi], 0, 0})});
    } else if (told.has_rates) {
      found.push_back({phi, begin, begin.follow({told.value, told.rate, told.acceleration})});
    } else {
      found.push_back({phi, begin, begin.reach(told.value, h)});
    }
  }
  return found;
}

}  // namespace

Stepping::Stepping(const System& system, double step, double alpha)
    : system_(system),
      step_(step),
      stepper_(system, integrators::HhtCoefficients::from_alpha(alpha), Loads{system.arm().gravity, {}, {}},
               {.reproducible = true}) {
  integrators::check_step(step);
}

Moment Stepping::advance(const Moment& from, const std::vector<JointInput>& inputs,
                         const std::vector<assembly::PointLoad>& points) {
  if (inputs.size() != system_.joints().size()) {
    throw InvalidParameter("one input for each of the " + std::to_string(system_.joints().size()) +
                           " joints is needed, got " + std::to_string(inputs.size()));
  }
  const std::vector<Path> driven = paths(system_, from.state, inputs, step_);
  const integrators::Drives drives = [&](double t, integrators::DriveValues& values) {
    system_.pedestal().shake(t, values.torques);
    const double x = (t - from.state.t) / step_;
    for (const Path& path : driven) {
      const Motion now = x > whole ? path.end.motion : path.at(step_, x);
      values.s[path.coordinate] = now.s;
      values.v[path.coordinate] = now.v;
      values.v_dot[path.coordinate] = now.v_dot;
    }
    for (std::size_t j = 0; j < inputs.size(); ++j) {
      if (system_.drives()[j] == DriveKind::torque) values.torques[system_.joints()[j].phi] = inputs[j].value;
    }
  };
  stepper_.recall(from.memory);
  stepper_.set_point_loads(points);
  Moment next{from.state, {}, from.steps + 1};
  if (from.steps == 0) {
    const Loads loads{system_.arm().gravity, points, {}};
    next.state = consistent_start(system_, {from.state, loads}, drives, from.state.t).state;
  }
  stepper_.advance(next.state, step_, drives);
  for (const Path& path : driven) next.state.a[system_.scalar_offset() + path.coordinate] = path.end.a;
  next.state.t = static_cast<double>(next.steps) * step_;  // no drift from adding up
  system_.closures().check(next.state.frames, system_.reach(), next.state.t);
  next.memory = stepper_.memory();
  return next;
}

}  // namespace flexarm::simulation
