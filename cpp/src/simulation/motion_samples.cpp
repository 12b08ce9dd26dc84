#include "flexarm/simulation/motion_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "flexarm/errors.hpp"

namespace flexarm::simulation {
namespace {

using Eigen::Index;
/// Difference of three values of a column, exact at the middle one for a parabola, or that of one side at an
/// end.
double difference(const InstantRef& time, const SampledRef& x, Index k, Index column) {
  const Index last = time.size() - 1;
  const auto slope = [&](Index i) { return (x(i + 1, column) - x(i, column)) / (time[i + 1] - time[i]); };
  if (k == 0 || k == last) return slope(std::min(k, last - 1));
  const double before = time[k] - time[k - 1], after = time[k + 1] - time[k];
  return (after * slope(k - 1) + before * slope(k)) / (before + after);
}

/// Equation (1) in one step at a time.
class SteppedCubic {
 public:
  SteppedCubic(const InstantRef& time, const SampledRef& x, const SampledRef& rates)
      : time_(time), x_(x), rates_(rates), d_(x.cols()), c_(x.cols()), v_(x.cols()) {}

  /// At an instant from the first time to the last.
  void evaluate(double instant, Eigen::Ref<Eigen::RowVectorXd> found) {
    if (instant == time_[time_.size() - 1]) {  // to the last digit, as at all other times
      found = x_.row(time_.size() - 1);
      return;
    }
    enter(instant);
    const double t = instant - time_[k_];
    found.array() = ((d_ * t + c_) * t + v_) * t + x_.row(k_).array();
  }

 private:
  /// Goes to the step of an instant, most often the present one or the next.
  void enter(double instant) {
    const auto holds = [&](Index k) {
      return k + 1 < time_.size() && time_[k] <= instant && instant < time_[k + 1];
    };
    if (k_ >= 0 && holds(k_)) return;
    if (k_ >= 0 && holds(k_ + 1)) {
      ++k_;
    } else {
      const double* begin = time_.data();
      k_ = std::upper_bound(begin, begin + time_.size(), instant) - begin - 1;
    }
    const double h = time_[k_ + 1] - time_[k_];
    for (Index j = 0; j < x_.cols(); ++j) {
      const double slope = (x_(k_ + 1, j) - x_(k_, j)) / h, next = rate(k_ + 1, j);
      v_[j] = rate(k_, j);
      d_[j] = (v_[j] + next - 2 * slope) / (h * h);
      c_[j] = (3 * slope - 2 * v_[j] - next) / h;
    }
  }

  double rate(Index k, Index column) const {
    return rates_.rows() > 0 ? rates_(k, column) : difference(time_, x_, k, column);
  }

  const InstantRef& time_;
  const SampledRef& x_;
  const SampledRef& rates_;
  Index k_ = -1;
  Eigen::Array<double, 1, Eigen::Dynamic> d_, c_, v_;
};

}  // namespace

SampledValues sample_motion(const InstantRef& time, const SampledRef& values, const SampledRef& rates,
                            const InstantRef& instants, double early) {
  const bool rated = rates.rows() > 0;
  const bool fits = !rated || (rates.rows() == values.rows() && rates.cols() == values.cols());
  if (time.size() == 0 || values.rows() != time.size() || !fits) {
    throw InvalidParameter("a motion needs values, and rates if any, at each of its times");
  }
  const double first = time[0], last = time[time.size() - 1];
  const double end = last + 1e-9 * std::max(1.0, std::abs(last));
  SampledValues found(instants.size(), values.cols());
  SteppedCubic cubic(time, values, rates);
  for (Index i = 0; i < instants.size(); ++i) {
    const double instant = instants[i];
    if (!(instant <= end)) {
      found.row(i).setConstant(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    cubic.evaluate(std::clamp(instant, first, last), found.row(i));
    if (rated && instant < first) found.row(i) += std::max(instant - first, -early) * rates.row(0);
  }
  return found;
}

}  // namespace flexarm::simulation
