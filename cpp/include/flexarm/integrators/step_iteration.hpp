/// @file
/// When the iteration of a step has come to its end, from the sizes of its increments (integrators/hht.hpp).
///
/// With the contraction ρ, the last size over the one before, the error left is ρ/(1 − ρ) times the last size
/// [HairerWanner1996]; of the first increment ρ is that of the step before.
#pragma once

#include "flexarm/integrators/hht.hpp"

namespace flexarm::integrators {

class StepIteration {
 public:
  enum class Verdict {
    go_on,
    converged,
    factor,  ///< with new factors
    failed,
  };

  /// @param steps accepted so far. @param contraction of the last step; renewed at the end of this one
  StepIteration(const HhtCoefficients& coefficients, const HhtOptions& options, double h, long steps,
                double& contraction);

  /// What to do after an increment of this size, which is done.
  Verdict judge(double size);

  int increments() const { return increments_; }
  /// Whether an increment was made with the factors at hand.
  bool again() const { return increments_ > 0 && !fresh_; }

 private:
  Verdict of_one_more(double size, int k);

  const HhtOptions& options_;
  double tolerance_;
  bool cautious_, fresh_ = false;
  double& contraction_;
  int increments_ = 0;
  double previous_ = 0;
};

}  // namespace flexarm::integrators
