#include "flexarm/simulation/piecewise_polynomial.hpp"

#include <algorithm>
#include <cmath>

#include "flexarm/errors.hpp"

namespace flexarm::simulation {
namespace {

// Times that differ by less are the same: adding up steps must not end a motion before its last instant.
constexpr double rounding = 1e-12;

void check(const std::vector<double>& breaks, const Eigen::MatrixXd& coefficients) {
  if (breaks.size() < 2 || coefficients.rows() < 1 ||
      coefficients.cols() + 1 != static_cast<Eigen::Index>(breaks.size())) {
    throw InvalidParameter(
        "a piecewise polynomial needs one column of coefficients between two breaks, got " +
        std::to_string(coefficients.cols()) + " columns and " + std::to_string(breaks.size()) + " breaks");
  }
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    if (!(breaks[k] < breaks[k + 1] && std::isfinite(breaks[k + 1] - breaks[k]))) {
      throw InvalidParameter("the breaks of a piecewise polynomial must be finite and rise, got " +
                             std::to_string(breaks[k + 1]) + " after " + std::to_string(breaks[k]));
    }
  }
  if (!coefficients.allFinite()) {
    throw InvalidParameter("the coefficients of a piecewise polynomial must be finite");
  }
}

}  // namespace

PiecewisePolynomial::PiecewisePolynomial(std::vector<double> breaks, Eigen::MatrixXd coefficients) {
  check(breaks, coefficients);
  pieces_ = std::make_shared<const Pieces>(Pieces{std::move(breaks), std::move(coefficients)});
}

PiecewisePolynomial PiecewisePolynomial::constant(double value) {
  return {{0.0, 1.0}, Eigen::MatrixXd::Constant(1, 1, value)};
}

std::array<double, 3> PiecewisePolynomial::operator()(double t) const {
  std::size_t piece = pieces_ ? pieces_->breaks.size() : 0;
  return (*this)(t, piece);
}

std::array<double, 3> PiecewisePolynomial::operator()(double t, std::size_t& piece) const {
  if (!pieces_) return {0.0, 0.0, 0.0};
  const std::vector<double>& breaks = pieces_->breaks;
  const Eigen::MatrixXd& coefficients = pieces_->coefficients;
  const double held = std::clamp(t, breaks.front(), breaks.back());
  const std::size_t last = breaks.size() - 2;
  const auto within = [&](std::size_t k) {
    return k <= last && (k == 0 || breaks[k] <= held) && (k == last || held < breaks[k + 1]);
  };
  if (!within(piece) && !within(++piece)) {
    const auto after = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, held);
    piece = static_cast<std::size_t>(after - breaks.begin() - 1);
  }
  const double x = held - breaks[piece];
  const double* coefficient = &coefficients(0, static_cast<Eigen::Index>(piece));
  double value = 0, first = 0, second = 0;  // Horner's scheme with derivatives
  for (Eigen::Index j = 0; j < coefficients.rows(); ++j) {
    second = second * x + 2 * first;
    first = first * x + value;
    value = value * x + coefficient[j];
  }
  if (std::abs(held - t) > rounding * std::max(1.0, std::abs(t))) return {value, 0.0, 0.0};
  return {value, first, second};
}

}  // namespace flexarm::simulation
