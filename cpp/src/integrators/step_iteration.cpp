#include "flexarm/integrators/step_iteration.hpp"

#include <algorithm>
#include <cmath>

namespace flexarm::integrators {
namespace {

// A contraction measured this many steps ago is measured again before it is trusted.
constexpr long trusted_steps = 16;
// It is a tenth of the one before at least: a step that happens to contract fast does not vouch for the next
// ones, as where a loop comes near a pose in line.
constexpr double least_change = 0.1;
// Increments below this are rounding: they neither shrink nor matter.
constexpr double rounding_floor = 1e-14;

}  // namespace

StepIteration::StepIteration(const HhtCoefficients& coefficients, const HhtOptions& options, double h,
                             long steps, double& contraction)
    : options_(options),
      tolerance_(coefficients.spectral_radius() < 1  // else what is left over adds up for ever
                     ? std::min(options.tolerance, options.acceleration_tolerance * coefficients.beta * h * h)
                     : rounding_floor),
      cautious_(steps % trusted_steps == 0),
      contraction_(contraction) {}

StepIteration::Verdict StepIteration::judge(double size) {
  const Verdict verdict = of_one_more(size, increments_);
  ++increments_;
  const bool ends = increments_ == options_.max_iterations && verdict != Verdict::converged;
  return ends ? Verdict::failed : verdict;
}

StepIteration::Verdict StepIteration::of_one_more(double size, int k) {
  if (!std::isfinite(size)) return Verdict::failed;
  const double rate = previous_ > 0 ? size / previous_ : contraction_;
  const double error = rate < 1 ? rate / (1 - rate) * size : size;
  if (error < tolerance_ && (k > 0 || !cautious_)) {
    if (previous_ > rounding_floor)
      contraction_ = std::clamp(std::max(rate, least_change * contraction_), 1e-4, 0.9);
    return Verdict::converged;
  }
  if (size < rounding_floor || (k > 1 && rate > 0.5 && size < options_.tolerance)) {
    return Verdict::converged;  // nothing to gain
  }
  if (k > 0 && rate > options_.slow_contraction && !fresh_) {
    fresh_ = true;
    previous_ = 0;
    contraction_ = 0.5;
    return Verdict::factor;
  }
  if (rate > 2) return Verdict::failed;
  previous_ = size;
  return Verdict::go_on;
}

}  // namespace flexarm::integrators
