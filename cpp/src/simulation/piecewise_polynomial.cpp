#include "flexarm/simulation/piecewise_polynomial.hpp"

#include <algorithm>
#include <cmath>

#include "flexarm/errors.hpp"

namespace flexarm::simulation {
namespace {

// Times that differ by less are the same: adding up steps must not end a motion before its last instant.
constexpr double rounding = 1e-12;

}  // namespace

PiecewisePolynomial::PiecewisePolynomial(std::vector<double> breaks, Eigen::MatrixXd coefficients)
    : breaks_(std::move(breaks)), coefficients_(std::move(coefficients)) {
  if (breaks_.size() < 2 || coefficients_.rows() < 1 ||
      coefficients_.cols() + 1 != static_cast<Eigen::Index>(breaks_.size())) {
    throw InvalidParameter(
        "a piecewise polynomial needs one column of coefficients between two breaks, got " +
        std::to_string(coefficients_.cols()) + " columns and " + std::to_string(breaks_.size()) + " breaks");
  }
  for (std::size_t k = 0; k + 1 < breaks_.size(); ++k) {
    if (!(breaks_[k] < breaks_[k + 1] && std::isfinite(breaks_[k + 1] - breaks_[k]))) {
      throw InvalidParameter("the breaks of a piecewise polynomial must be finite and rise, got " +
                             std::to_string(breaks_[k + 1]) + " after " + std::to_string(breaks_[k]));
    }
  }
  if (!coefficients_.allFinite()) {
    throw InvalidParameter("the coefficients of a piecewise polynomial must be finite");
  }
}

PiecewisePolynomial PiecewisePolynomial::constant(double value) {
  return {{0.0, 1.0}, Eigen::MatrixXd::Constant(1, 1, value)};
}

std::array<double, 3> PiecewisePolynomial::operator()(double t) const {
  std::size_t piece = breaks_.size();
  return (*this)(t, piece);
}

std::array<double, 3> PiecewisePolynomial::operator()(double t, std::size_t& piece) const {
  if (breaks_.empty()) return {0.0, 0.0, 0.0};
  const double held = std::clamp(t, breaks_.front(), breaks_.back());
  const std::size_t last = breaks_.size() - 2;
  const auto within = [&](std::size_t k) {
    return k <= last && (k == 0 || breaks_[k] <= held) && (k == last || held < breaks_[k + 1]);
  };
  if (!within(piece) && !within(++piece)) {
    const auto after = std::upper_bound(breaks_.begin() + 1, breaks_.end() - 1, held);
    piece = static_cast<std::size_t>(after - breaks_.begin() - 1);
  }
  const double x = held - breaks_[piece];
  const double* coefficient = &coefficients_(0, static_cast<Eigen::Index>(piece));
  double value = 0, first = 0, second = 0;  // Horner's scheme with derivatives
  for (Eigen::Index j = 0; j < coefficients_.rows(); ++j) {
    second = second * x + 2 * first;
    first = first * x + value;
    value = value * x + coefficient[j];
  }
  if (std::abs(held - t) > rounding * std::max(1.0, std::abs(t))) return {value, 0.0, 0.0};
  return {value, first, second};
}

}  // namespace flexarm::simulation
