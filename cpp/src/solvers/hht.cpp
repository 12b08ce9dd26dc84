#include "flexarm/solvers/hht.hpp"

#include <cmath>
#include <cstdio>

#include "flexarm/errors.hpp"
#include "flexarm/solvers/increment.hpp"
#include "flexarm/solvers/step_iteration.hpp"
#include "flexarm/solvers/step_matrix.hpp"

namespace flexarm::solvers {
HhtCoefficients HhtCoefficients::from_alpha(double alpha) {
  if (!(alpha >= -1.0 / 3 - 1e-12 && alpha <= 0)) {
    throw InvalidParameter("alpha of the HHT method must lie in [-1/3, 0], got " + std::to_string(alpha));
  }
  return {alpha, (1 - alpha) * (1 - alpha) / 4, 0.5 - alpha};
}

HhtCoefficients HhtCoefficients::from_spectral_radius(double rho) {
  if (!(rho >= 0.5 && rho <= 1)) {
    throw InvalidParameter("spectral radius of the HHT method must lie in [1/2, 1], got " +
                           std::to_string(rho));
  }
  return from_alpha((rho - 1) / (rho + 1));
}

void check_step(double h) {
  if (h >= shortest_step && std::isfinite(h)) return;
  char text[100];
  std::snprintf(text, sizeof text, "step must be positive, at least %g s and finite, got %g s", shortest_step,
                h);
  throw InvalidParameter(text);
}

template <int D>
HhtStepperIn<D>::HhtStepperIn(const SystemIn<D>& system, const HhtCoefficients& coefficients,
                              const LoadsIn<D>& loads, HhtOptions options)
    : system_(system),
      coefficients_(coefficients),
      loads_(loads),
      options_(options),
      matrix_(system),
      mass_scale_(constraint_scale(system)),
      exponent_(VectorXd::Zero(system.n_free())),
      r_(system.n_velocities()),
      phi_(system.n_constraints()),
      dx_(system.n_unknowns()),
      welds_(system, options.weld),
      reduced_(welds_.n_unknowns()),
      changes_(system, welds_) {
  const VectorXd zero = VectorXd::Zero(system.n_scalars());
  drive_ = {zero, zero, zero, zero};
}

template <int D>
void HhtStepperIn<D>::advance(StateIn<D>& state, double h, const Drives& drives) {
  if (step(state, h, drives)) return;
  const StateIn<D> before = state;
  try {
    halve(state, h, drives, 1);
  } catch (const NotConverged&) {
    state = before;
    throw;
  }
}

template <int D>
void HhtStepperIn<D>::halve(StateIn<D>& state, double h, const Drives& drives, int depth) {
  if (depth > options_.max_halvings) {
    const double residual = r_.head(system_.n_free()).template lpNorm<Eigen::Infinity>();
    const bool undamped = coefficients_.alpha == 0 && !system_.closures().empty();
    char text[320];
    std::snprintf(text, sizeof text,
                  "step %ld, t = %.6g s: residual %.1e N left after %d iterations%s, with the step halved %d "
                  "times to %.1e s%s",
                  statistics_.steps + 1, state.t + h, residual, iteration_,
                  singular_ ? ", where the matrix is singular or not finite" : "", options_.max_halvings, h,
                  undamped
                      ? "; in closed loops alpha = 0 lets forces alternate from step to step, and halved "
                        "steps feed that: take alpha = -0.05"
                      : "");
    throw NotConverged(text, state.t + h, iteration_, residual);
  }
  ++statistics_.halvings;
  for (int half = 0; half < 2; ++half) {
    if (!step(state, 0.5 * h, drives)) halve(state, 0.5 * h, drives, depth + 1);
  }
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
  if (factored_h_ != h) {
    drives(state.t + h, drive_);
    loads_.torques = drive_.torques;
    const double t = state.t;
    state.t += h;
    const bool regular = factor(state, h);
    iteration_ = 0;
    if (!regular) system_.evaluate(state, loads_, r_, phi_, welds_.joints());  // for the message
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
    factored_h_ = 0;
    return false;
  }
  remember_laws(system_, state);
  ++statistics_.steps;
  if (follower_) follower_(before_, state, exponent_, h, loads_);
  ++memory_.steps;
  return true;
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
void HhtStepperIn<D>::correct(StateIn<D>& state, double h) {
  const auto [alpha, beta, gamma] = coefficients_;
  const int n = system_.n_free();
  const double per_h2 = 1 / (beta * h * h);
  const double per_h = gamma * h * per_h2, per_h2_v_dot = per_h2 / (1 + alpha);
  const double* __restrict dx = dx_.data();
  double *__restrict x = exponent_.data(), *__restrict v = state.v.data(), *__restrict a = state.a.data(),
         *__restrict v_dot = state.v_dot.data();
  for (int k = 0; k < n; ++k) {
    x[k] += dx[k];
    a[k] += per_h2 * dx[k];
    v[k] += per_h * dx[k];
    v_dot[k] += per_h2_v_dot * dx[k];
  }
  state.multipliers += mass_scale_ * per_h2 * dx_.tail(system_.n_constraints());
  place(state);
}

/// Nodes and free scalar coordinates of state 1 from the exponent, eq. (3).
template <int D>
[[gnu::flatten]] void HhtStepperIn<D>::place(StateIn<D>& state) const {
  constexpr int n = geometry::freedoms<D>;
  using geometry::Two;
  const std::vector<int>& nodes = welds_.carriers();
  std::size_t at = 0;
  for (; at + 1 < nodes.size(); at += 2) {  // two nodes at a time
    const int first = nodes[at], second = nodes[at + 1];
    geometry::Twist<D, Two> h;
    for (int i = 0; i < n; ++i) h[i] = Two(exponent_[n * first + i], exponent_[n * second + i]);
    const auto H = geometry::side_by_side<D>(before_.frames[first], before_.frames[second]) *
                   geometry::exponential<D, Two>(h);
    state.frames[first] = geometry::lane<D>(H, 0);
    state.frames[second] = geometry::lane<D>(H, 1);
  }
  if (at < nodes.size()) {
    const int k = nodes[at];
    state.frames[k] = before_.frames[k] * geometry::exponential<D>(exponent_.template segment<n>(n * k));
  }
  welds_.place(state.frames);
  const int n_free_scalars = system_.n_free() - system_.scalar_offset();
  state.s.head(n_free_scalars) = before_.s.head(n_free_scalars) + exponent_.tail(n_free_scalars);
}

template <int D>
bool HhtStepperIn<D>::iterate(StateIn<D>& state, double h) {
  using Verdict = StepIteration::Verdict;
  StepIteration iteration(coefficients_, options_, h, memory_.steps, memory_.contraction);
  for (;;) {
    system_.evaluate(state, loads_, r_, phi_, welds_.joints());
    solve(state, h, iteration.again());  // eq. (5)
    ++statistics_.iterations;
    iteration_ = iteration.increments() + 1;
    if (!std::isfinite(dx_.sum())) return false;  // as is the sum of what is not
    const double size = increment_norm(system_, dx_);
    correct(state, h);
    switch (iteration.judge(size)) {
      case Verdict::converged:
        return true;
      case Verdict::failed:
        return false;
      case Verdict::factor:
        if (!factor(state, h)) return false;
        break;
      case Verdict::go_on:
        break;
    }
  }
}

template <int D>
HhtMemoryIn<D> HhtStepperIn<D>::memory() const {
  HhtMemoryIn<D> memory = memory_;
  if (factored_h_ == 0) memory.factored = nullptr;
  return memory;
}

template <int D>
void HhtStepperIn<D>::recall(const HhtMemoryIn<D>& memory) {
  const bool at_hand = factored_h_ != 0 && memory.factored == memory_.factored;
  memory_ = memory;
  if (at_hand) return;
  factored_h_ = 0;
  if (memory.factored == nullptr) return;
  const LinearisationIn<D>& at = *memory.factored;
  loads_ = at.loads;
  if (!factor(at.state, at.h)) {
    throw NotConverged("the matrix that was factored at t = " + std::to_string(at.state.t) + " s is singular",
                       at.state.t, 0, 0);
  }
  memory_.factored = memory.factored;
}

template <int D>
bool HhtStepperIn<D>::factor(const StateIn<D>& state, double h) {
  const assembly::TangentFactors c = step_factors(coefficients_, h, mass_scale_);
  const VectorXd law_tangents = system_.law_tangents(state, c, true);
  ++statistics_.factorisations;
  if (options_.reproducible) {  // neither the pattern nor the pivots of earlier numbers
    memory_.factored = std::make_shared<const LinearisationIn<D>>(state, loads_, h);
    matrix_.forget();
    factor_ = KeptFactor();
  }
  const Eigen::SparseMatrix<double>* S = matrix_.assemble(state, loads_, c, law_tangents);
  singular_ = S == nullptr || !factor_.factor(welds_.any() ? welds_.reduce(*S) : *S);
  if (singular_) {
    factored_h_ = 0;
    return false;
  }
  factored_h_ = h;
  changes_.keep(state, c, law_tangents, factor_.by_substitution());
  return true;
}

/// dx := S⁻¹ (−r, −s Φ), with what has changed in S since it was factored. @param again in this step
template <int D>
void HhtStepperIn<D>::solve(const StateIn<D>& state, double h, bool again) {
  dx_.head(system_.n_free()) = -r_.head(system_.n_free());
  dx_.tail(system_.n_constraints()) = -mass_scale_ / (coefficients_.beta * h * h) * phi_;
  if (!welds_.any()) {
    factor_.solve(dx_);
    changes_.correct(state, dx_, again);
    return;
  }
  welds_.fold(dx_, reduced_);
  factor_.solve(reduced_);
  changes_.correct(state, reduced_, again);
  welds_.unfold(reduced_, dx_);
}

template class HhtStepperIn<2>;
template class HhtStepperIn<3>;

}  // namespace flexarm::solvers
