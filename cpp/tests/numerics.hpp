/// @file
/// What the tests measure with: seeded random numbers, differences, errors, observed orders.
#pragma once

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <random>

namespace flexarm::tests {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The same numbers in every run.
class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}

  /// Uniform in [low, high].
  double operator()(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  /// Entries uniform in [−size, size].
  VectorXd vector(Eigen::Index n, double size = 1) {
    VectorXd x(n);
    for (double& entry : x) entry = (*this)(-size, size);
    return x;
  }
  Eigen::Matrix<double, 6, 1> twist(double translation, double rotation) {
    Eigen::Matrix<double, 6, 1> h;
    h << vector(3, translation), vector(3, rotation);
    return h;
  }
  Eigen::Vector3d unit() {
    std::normal_distribution<double> normal;
    return Eigen::Vector3d(normal(generator_), normal(generator_), normal(generator_)).normalized();
  }

 private:
  std::mt19937 generator_;
};

/// ∂f/∂x at x = 0 by the five-point formula: with a step of 1e-3 its error, h⁴ f⁽⁵⁾/30 and rounding, stays
/// near 1e-12 of f.
inline MatrixXd differences(const std::function<VectorXd(const VectorXd&)>& f, int n, double h = 1e-3) {
  MatrixXd J;
  for (int k = 0; k < n; ++k) {
    const VectorXd e = VectorXd::Unit(n, k);
    const VectorXd column = (8 * (f(h * e) - f(-h * e)) - (f(2 * h * e) - f(-2 * h * e))) / (12 * h);
    if (k == 0) J.resize(column.size(), n);
    J.col(k) = column;
  }
  return J;
}

/// df/dx at x by the same formula.
inline double derivative(const std::function<double(double)>& f, double x, double h) {
  return (8 * (f(x + h) - f(x - h)) - (f(x + 2 * h) - f(x - 2 * h))) / (12 * h);
}

inline double largest(const Eigen::Ref<const MatrixXd>& A) {
  return A.size() == 0 ? 0 : A.cwiseAbs().maxCoeff();
}

/// Largest difference, in parts of the largest entry of `expected`.
inline double relative_error(const Eigen::Ref<const MatrixXd>& found,
                             const Eigen::Ref<const MatrixXd>& expected) {
  return largest(found - expected) / std::max(largest(expected), 1e-300);
}

inline double error(const Eigen::Ref<const MatrixXd>& found, const Eigen::Ref<const MatrixXd>& expected) {
  return largest(found - expected);
}

/// Equal within a part `tolerance` of the value itself: doctest's own would add the tolerance as it stands,
/// and so accept anything small.
inline doctest::Approx near(double value, double tolerance = 1e-12) {
  return doctest::Approx(value).epsilon(tolerance).scale(1e-200);
}

/// Order of convergence from the errors at steps h and h/2.
inline double observed_order(double error_h, double error_half) { return std::log2(error_h / error_half); }

}  // namespace flexarm::tests
