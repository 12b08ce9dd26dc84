#include "flexarm/integrators/hht.hpp"

#include <cmath>

#include "flexarm/integrators/increment.hpp"
#include "flexarm/integrators/step_iteration.hpp"

namespace flexarm::integrators {

template <int D>
HhtStepperIn<D>::HhtStepperIn(const SystemIn<D>& system, const HhtCoefficients& coefficients,
                              const LoadsIn<D>& loads, HhtOptions options)
    : system_(system),
      coefficients_(coefficients),
      loads_(loads),
      options_(options),
      solver_(system, coefficients, options),
      exponent_(VectorXd::Zero(system.n_free())),
      r_(system.n_velocities()),
      phi_(system.n_constraints()) {
  const VectorXd zero = VectorXd::Zero(system.n_scalars());
  drive_ = {zero, zero, zero, zero};
}

/// State 0 moves into before_; all of state 1 that a step does not write stays what it was in state 0.
template <int D>
void HhtStepperIn<D>::set_aside(StateIn<D>& state) {
  std::swap(before_, state);
  const bool fits = state.frames.size() == before_.frames.size() && state.v.size() == before_.v.size() &&
                    state.laws.size() == before_.laws.size();
  if (!fits) {
    state = before_;
    return;
  }
  const int n_driven = system_.n_velocities() - system_.n_free();
  state.start = before_.start;
  state.a.tail(n_driven) = before_.a.tail(n_driven);
  state.multipliers = before_.multipliers;
  state.laws = before_.laws;
}

template <int D>
bool HhtStepperIn<D>::step(StateIn<D>& state, double h, const Drives& drives) {
  if (!solver_.has_factors(h)) {
    drives(state.t + h, drive_);
    loads_.torques = drive_.torques;
    const double t = state.t;
    state.t += h;
    const bool regular = factor(state, h);
    iteration_ = 0;
    if (!regular)
      system_.evaluate(state, loads_, r_, phi_, solver_.condensation().joints());  // for the message
    state.t = t;
    if (!regular) return false;
  }
  set_aside(state);
  state.t = before_.t + h;
  drives(state.t, drive_);
  loads_.torques = drive_.torques;
  predict(state, h);
  if (!iterate(state, h)) {
    std::swap(before_, state);
    solver_.forget_factors();
    return false;
  }
  remember_laws(system_, state);
  ++statistics_.steps;
  if (observer_) observer_(before_, state, exponent_, h, loads_);
  ++memory_.steps;
  return true;
}

template <int D>
bool HhtStepperIn<D>::factor(const StateIn<D>& state, double h) {
  ++statistics_.factorisations;
  return solver_.factor(state, loads_, h);
}

/// State 1 with the accelerations of state 0, so that a₁ = v̇₀ by (2); prescribed coordinates from the drives.
template <int D>
void HhtStepperIn<D>::predict(StateIn<D>& state, double h) {
  const auto [alpha, beta, gamma] = coefficients_;
  const int n = system_.n_free(), n_driven = system_.n_velocities() - n;
  const double h2_a = h * h * (0.5 - beta), h2_v_dot = h * h * beta, h_a = h * (1 - gamma),
               h_v_dot = h * gamma;
  const double *__restrict v0 = before_.v.data(), *__restrict a0 = before_.a.data(),
               *__restrict v_dot0 = before_.v_dot.data();
  double *__restrict x = exponent_.data(), *__restrict v = state.v.data(), *__restrict a = state.a.data(),
         *__restrict v_dot = state.v_dot.data();
  for (int k = 0; k < n; ++k) {  // in one pass: the vectors are short, and setting out takes its time
    x[k] = h * v0[k] + h2_a * a0[k] + h2_v_dot * v_dot0[k];  // eq. (3)
    v[k] = v0[k] + h_a * a0[k] + h_v_dot * v_dot0[k];        // eq. (4)
    v_dot[k] = a[k] = v_dot0[k];
  }
  state.s.tail(n_driven) = drive_.s.tail(n_driven);
  state.v.tail(n_driven) = drive_.v.tail(n_driven);
  state.v_dot.tail(n_driven) = drive_.v_dot.tail(n_driven);
  place(state);
}

/// Adds Δ of (5) to the exponent, and by (3), (4) and (2) what belongs to it to a₁, v₁ and v̇₁.
template <int D>
void HhtStepperIn<D>::correct(StateIn<D>& state, const VectorXd& delta, double h) {
  const auto [alpha, beta, gamma] = coefficients_;
  const int n = system_.n_free();
  const double per_h2 = 1 / (beta * h * h);
  const double per_h = gamma * h * per_h2, per_h2_v_dot = per_h2 / (1 + alpha);
  const double* __restrict dx = delta.data();
  double *__restrict x = exponent_.data(), *__restrict v = state.v.data(), *__restrict a = state.a.data(),
         *__restrict v_dot = state.v_dot.data();
  for (int k = 0; k < n; ++k) {
    x[k] += dx[k];
    a[k] += per_h2 * dx[k];
    v[k] += per_h * dx[k];
    v_dot[k] += per_h2_v_dot * dx[k];
  }
  state.multipliers += delta.tail(system_.n_constraints());
  place(state);
}

/// Nodes and free scalar coordinates of state 1 from the exponent, eq. (3).
template <int D>
void HhtStepperIn<D>::place(StateIn<D>& state) const {
  move_nodes<D>(solver_.condensation().carriers(), before_.frames, exponent_, state.frames);
  solver_.condensation().place(state.frames);
  const int n_free_scalars = system_.n_free() - system_.scalar_offset();
  state.s.head(n_free_scalars) = before_.s.head(n_free_scalars) + exponent_.tail(n_free_scalars);
}

template <int D>
bool HhtStepperIn<D>::iterate(StateIn<D>& state, double h) {
  using Verdict = StepIteration::Verdict;
  StepIteration iteration(coefficients_, options_, h, memory_.steps, memory_.contraction);
  for (;;) {
    system_.evaluate(state, loads_, r_, phi_, solver_.condensation().joints());
    const VectorXd& delta = solver_.solve(state, r_, phi_, h, iteration.again());  // eq. (5)
    ++statistics_.iterations;
    iteration_ = iteration.increments() + 1;
    if (!std::isfinite(delta.sum())) return false;  // as is the sum of what is not
    const double size = increment_norm(system_, delta);
    correct(state, delta, h);
    const Verdict verdict = iteration.judge(size);
    if (verdict == Verdict::converged) return true;
    if (verdict == Verdict::failed || (verdict == Verdict::factor && !factor(state, h))) return false;
  }
}

template <int D>
HhtMemoryIn<D> HhtStepperIn<D>::memory() const {
  HhtMemoryIn<D> memory = memory_;
  memory.factored = solver_.factored();
  return memory;
}

template <int D>
void HhtStepperIn<D>::recall(const HhtMemoryIn<D>& memory) {
  memory_ = memory;
  solver_.recall(memory.factored);
}

template class HhtStepperIn<2>;
template class HhtStepperIn<3>;

}  // namespace flexarm::integrators
