#include "flexarm/linear_solvers/lower_triangle.hpp"

#include <algorithm>

#include "flexarm/linear_solvers/wide_rows.hpp"

namespace flexarm::linear_solvers {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

struct Product {
  template <int V>
  [[gnu::always_inline]] static inline void run(const LowerTriangle& A, const double* X, double* Y) {
    for (Index j = 0; j < A.cols(); ++j) {
      Four x[V], y[V];
      for (int v = 0; v < V; ++v) {
        x[v] = row<V>(X, j)[v];
        y[v] = row<V>(Y, j)[v];
      }
      for (LowerTriangle::InnerIterator it(A, j); it; ++it) {
        const double a = it.value();
        if (it.row() == j) {
          for (int v = 0; v < V; ++v) y[v] += a * x[v];
          continue;
        }
        const FourInPlace* other = row<V>(X, it.row());
        FourInPlace* sum = row<V>(Y, it.row());
        for (int v = 0; v < V; ++v) {
          y[v] += a * other[v];
          sum[v] += a * x[v];
        }
      }
      for (int v = 0; v < V; ++v) row<V>(Y, j)[v] = y[v];
    }
  }
};

}  // namespace

MatrixXd multiply(const LowerTriangle& A, const Eigen::Ref<const MatrixXd>& X) {
  MatrixXd Y(X.rows(), X.cols()), rows, sums;
  for (Index k = 0, p; k < X.cols(); k += p) {
    const int width = width_of(X.cols() - k);
    p = std::min<Index>(width, X.cols() - k);
    if (p < width) rows.setZero(width, X.rows());
    rows.resize(width, X.rows());
    rows.topRows(p) = X.middleCols(k, p).transpose();
    sums.setZero(width, X.rows());
    in_wide_rows<Product>(width, A, rows.data(), sums.data());
    Y.middleCols(k, p) = sums.topRows(p).transpose();
  }
  return Y;
}

}  // namespace flexarm::linear_solvers
