#include "flexarm/solvers/lower_triangle.hpp"

#include <algorithm>

namespace flexarm::solvers {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Columns of X that meet an entry of A together.
constexpr Index together = 16;

/// Rows of X and of the product lie together: an entry of A moves whole rows.
template <int p>
void multiply_rows(const LowerTriangle& A, const double* X, double* Y) {
  using Row = Eigen::Map<const Eigen::Matrix<double, p, 1>>;
  using Sum = Eigen::Map<Eigen::Matrix<double, p, 1>>;
  for (Index j = 0; j < A.cols(); ++j) {
    const Eigen::Matrix<double, p, 1> x = Row(X + p * j);
    Eigen::Matrix<double, p, 1> y = Sum(Y + p * j);
    for (LowerTriangle::InnerIterator it(A, j); it; ++it) {
      const Index i = it.row();
      const double a = it.value();
      if (i == j) {
        y += a * x;
        continue;
      }
      y += a * Row(X + p * i);
      Sum(Y + p * i) += a * x;
    }
    Sum(Y + p * j) = y;
  }
}

}  // namespace

MatrixXd multiply(const LowerTriangle& A, const Eigen::Ref<const MatrixXd>& X) {
  MatrixXd Y(X.rows(), X.cols());
  MatrixXd rows, sums;
  const auto block = [&]<int p>(std::integral_constant<int, p>, Index k) {
    rows = X.middleCols<p>(k).transpose();
    sums.setZero(p, X.rows());
    multiply_rows<p>(A, rows.data(), sums.data());
    Y.middleCols<p>(k) = sums.transpose();
    return k + p;
  };
  Index k = 0;
  while (X.cols() - k >= together) k = block(std::integral_constant<int, together>(), k);
  while (X.cols() - k >= 8) k = block(std::integral_constant<int, 8>(), k);
  while (X.cols() - k >= 4) k = block(std::integral_constant<int, 4>(), k);
  while (X.cols() - k >= 1) k = block(std::integral_constant<int, 1>(), k);
  return Y;
}

}  // namespace flexarm::solvers
