/// Steps of integrators/hht.hpp that are halved where Newton's iteration fails.
#include <cstdio>

#include "flexarm/errors.hpp"
#include "flexarm/integrators/hht.hpp"

namespace flexarm::integrators {

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
    std::snprintf(
        text, sizeof text,
        "t = %.6g s: residual %.1e N left after %d iterations%s, with the step halved %d "
        "times to %.1e s%s",
        state.t + h, residual, iteration_,
        solver_.singular() ? ", where the matrix is singular or not finite" : "", options_.max_halvings, h,
        undamped ? "; in closed loops alpha = 0 lets forces alternate from step to step, and halved "
                   "steps feed that: take alpha = -0.05"
                 : "");
    throw NotConverged(text, state.t + h, iteration_, residual);
  }
  ++statistics_.halvings;
  for (int half = 0; half < 2; ++half) {
    if (!step(state, 0.5 * h, drives)) halve(state, 0.5 * h, drives, depth + 1);
  }
}

template void HhtStepperIn<2>::advance(StateIn<2>&, double, const Drives&);
template void HhtStepperIn<3>::advance(StateIn<3>&, double, const Drives&);

}  // namespace flexarm::integrators
