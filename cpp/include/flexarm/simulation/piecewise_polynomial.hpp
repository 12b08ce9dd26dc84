/// @file
/// Piecewise polynomial in time, as SciPy's PPoly: on [x_k, x_{k+1}) the value is Σ c_j (t − x_k)^(m − j), j
/// = 0..m, and before the first and after the last break the end value is held, at rest.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

namespace flexarm::simulation {

/// Copies share the numbers: a drive of a long record is handed on several times before it is read.
class PiecewisePolynomial {
 public:
  PiecewisePolynomial() = default;  ///< zero at all times
  /// @param breaks rising, n + 1 of them [s]; @param coefficients (order + 1, n), highest power first.
  /// @throws InvalidParameter if the shapes do not fit or breaks do not rise.
  PiecewisePolynomial(std::vector<double> breaks, Eigen::MatrixXd coefficients);
  static PiecewisePolynomial constant(double value);

  /// Value and its first two derivatives.
  std::array<double, 3> operator()(double t) const;
  /// The same; the piece where t lies is looked for from `piece` on and left there.
  std::array<double, 3> operator()(double t, std::size_t& piece) const;

 private:
  struct Pieces {
    std::vector<double> breaks;
    Eigen::MatrixXd coefficients;
  };
  std::shared_ptr<const Pieces> pieces_;  // null: zero
};

}  // namespace flexarm::simulation
