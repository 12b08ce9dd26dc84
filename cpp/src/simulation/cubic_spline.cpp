#include "flexarm/simulation/cubic_spline.hpp"

#include <string>

#include "flexarm/errors.hpp"

namespace flexarm::simulation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// First entry of the right-hand side of (2), from the two steps and quotients next to an end.
double end_condition(double h_0, double h_1, double delta_0, double delta_1) {
  return ((3 * h_0 + 2 * h_1) * h_1 * delta_0 + h_0 * h_0 * delta_1) / (h_0 + h_1);
}

/// Slopes at the samples, four or more. (1) and (2) are tridiagonal, and elimination in their order meets
/// positive pivots only: h_k + h_{k−1} or more in the rows (1), h²_{m−2}/(2 h_{m−2} + h_{m−1}) in the last.
VectorXd slopes(const VectorXd& h, const VectorXd& delta) {
  const Index m = h.size();
  VectorXd pivot(m + 1), superdiagonal(m), d(m + 1);
  pivot[0] = h[1];
  superdiagonal[0] = h[0] + h[1];
  d[0] = end_condition(h[0], h[1], delta[0], delta[1]);  // eq. (2)
  for (Index k = 1; k < m; ++k) {                        // eq. (1)
    const double factor = h[k] / pivot[k - 1];
    pivot[k] = 2 * (h[k - 1] + h[k]) - factor * superdiagonal[k - 1];
    superdiagonal[k] = h[k - 1];
    d[k] = 3 * (h[k] * delta[k - 1] + h[k - 1] * delta[k]) - factor * d[k - 1];
  }
  const double factor = (h[m - 1] + h[m - 2]) / pivot[m - 1];
  pivot[m] = h[m - 2] - factor * superdiagonal[m - 1];
  d[m] = end_condition(h[m - 1], h[m - 2], delta[m - 1], delta[m - 2]) - factor * d[m - 1];
  d[m] /= pivot[m];
  for (Index k = m - 1; k >= 0; --k) d[k] = (d[k] - superdiagonal[k] * d[k + 1]) / pivot[k];
  return d;
}

/// Slopes of the one polynomial through two or three samples.
VectorXd slopes_of_few(const VectorXd& h, const VectorXd& delta) {
  if (h.size() == 1) return VectorXd::Constant(2, delta[0]);
  const double half_bend = (delta[1] - delta[0]) / (h[0] + h[1]);
  VectorXd d(3);
  d << delta[0] - half_bend * h[0], delta[0] + half_bend * h[0], delta[1] + half_bend * h[1];
  return d;
}

}  // namespace

Eigen::MatrixXd cubic_spline(const VectorXd& x, const VectorXd& y) {
  if (x.size() < 2 || y.size() != x.size()) {
    throw InvalidParameter("a spline needs two samples or more, one value at each instant, got " +
                           std::to_string(x.size()) + " instants and " + std::to_string(y.size()) +
                           " values");
  }
  const Index m = x.size() - 1;
  const VectorXd h = x.tail(m) - x.head(m);
  if (!(h.array() > 0).all() || !x.allFinite() || !y.allFinite()) {
    throw InvalidParameter("the samples of a spline must be finite and its instants rise");
  }
  const VectorXd delta = (y.tail(m) - y.head(m)).cwiseQuotient(h);
  const VectorXd d = m < 3 ? slopes_of_few(h, delta) : slopes(h, delta);
  Eigen::MatrixXd c(4, m);
  for (Index k = 0; k < m; ++k) {  // eq. (3)
    const double jerk = (d[k] + d[k + 1] - 2 * delta[k]) / h[k];
    c.col(k) << jerk / h[k], (delta[k] - d[k]) / h[k] - jerk, d[k], y[k];
  }
  return c;
}

}  // namespace flexarm::simulation
