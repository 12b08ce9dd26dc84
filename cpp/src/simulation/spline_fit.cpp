#include "flexarm/simulation/spline_fit.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "flexarm/errors.hpp"

namespace flexarm::simulation {
namespace {

using Eigen::Index;
using Eigen::Vector4d;

/// The four B-splines that are not zero in an interval, by (2).
class IntervalBasis {
 public:
  /// Between the third and the fourth of six rising knots.
  explicit IntervalBasis(const std::array<double, 6>& knots) : knots_(knots) {
    for (int degree = 1, at = 0; degree <= 3; ++degree) {
      for (int j = 3 - degree; j < 3; ++j, ++at) inverse_width_[at] = 1 / (knots[j + degree] - knots[j]);
    }
  }

  Vector4d operator()(double t) const {
    Vector4d b(1, 0, 0, 0);
    for (int degree = 1, at = 0; degree <= 3; ++degree) {
      double from_left = 0;
      for (int k = 0; k < degree; ++k, ++at) {
        const double part = b[k] * inverse_width_[at];
        b[k] = from_left + (knots_[3 + k] - t) * part;  // eq. (2)
        from_left = (t - knots_[3 - degree + k]) * part;
      }
      b[degree] = from_left;
    }
    return b;
  }

 private:
  std::array<double, 6> knots_;
  std::array<double, 6> inverse_width_{};
};

void check_breaks(const SampleRef& time, const BreakRef& breaks) {
  bool rising = breaks.size() > 1 && breaks[0] == 0 && breaks[breaks.size() - 1] == time.size() - 1;
  for (Index k = 1; rising && k < breaks.size(); ++k) {
    rising = breaks[k - 1] < breaks[k] && time[breaks[k - 1]] < time[breaks[k]];
  }
  if (!rising) {
    throw InvalidParameter(
        "breaks of a spline, and its instants there, must rise from its first sample to "
        "its last");
  }
}

/// Calls visit(interval, sample, B-splines there) for all samples; that at a break belongs to what follows
/// it.
template <class Visit>
void for_each_sample(const SampleRef& time, const BreakRef& breaks, const Visit& visit) {
  const Index m = breaks.size() - 1;
  for (Index k = 0; k < m; ++k) {
    std::array<double, 6> knots{};
    for (Index j = 0; j < 6; ++j) knots[j] = time[breaks[std::clamp<Index>(k - 2 + j, 0, m)]];
    const IntervalBasis basis(knots);
    const Index end = breaks[k + 1] + (k + 1 == m ? 1 : 0);
    for (Index i = breaks[k]; i < end; ++i) visit(k, i, basis(time[i]));
  }
}

}  // namespace

SplineEquations spline_equations(const SampleRef& time, const SampleRef& values, const BreakRef& breaks) {
  check_breaks(time, breaks);
  if (values.size() != time.size()) {
    throw InvalidParameter("a spline needs one value at each of " + std::to_string(time.size()) +
                           " instants, got " + std::to_string(values.size()));
  }
  const Index count = breaks.size() + 2;
  SplineEquations found{Eigen::MatrixXd::Zero(4, count), Eigen::VectorXd::Zero(count)};
  for_each_sample(time, breaks, [&](Index k, Index i, const Vector4d& b) {  // eq. (1)
    found.right.segment<4>(k) += values[i] * b;
    for (Index j = 0; j < 4; ++j) {
      for (Index below = 0; below < 4 - j; ++below) found.band(below, k + j) += b[j] * b[j + below];
    }
  });
  return found;
}

Eigen::VectorXd spline_values(const SampleRef& time, const BreakRef& breaks, const SampleRef& coefficients) {
  check_breaks(time, breaks);
  if (coefficients.size() != breaks.size() + 2) {
    throw InvalidParameter("a cubic spline on " + std::to_string(breaks.size() - 1) + " intervals needs " +
                           std::to_string(breaks.size() + 2) + " coefficients, got " +
                           std::to_string(coefficients.size()));
  }
  Eigen::VectorXd found(time.size());
  for_each_sample(time, breaks,
                  [&](Index k, Index i, const Vector4d& b) { found[i] = coefficients.segment<4>(k).dot(b); });
  return found;
}

}  // namespace flexarm::simulation
