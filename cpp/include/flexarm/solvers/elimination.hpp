/// @file
/// A x = b for a few unknowns, as many as are known when compiled: Gaussian elimination with partial
/// pivoting,
///
///     row_i −= (a_ik/a_kk) row_k,  i > k,  a_kk the largest of what is left of its column             (1)
///     x_k = (b_k − Σ a_kj x_j)/a_kk,  j > k                                                          (2)
///
/// Eigen's factorisation has sizes of run time within, which takes longer than the elimination itself where
/// it is done once a step. Source: [Golub2013], section 3.4.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace flexarm::solvers {

/// x replaces b, and A is lost. A singular matrix leaves what is not a finite number.
template <int N>
void eliminate(Eigen::Matrix<double, N, N, Eigen::RowMajor>& A, Eigen::Matrix<double, N, 1>& b) {
  for (int k = 0; k < N; ++k) {
    int pivot = k;
    for (int i = k + 1; i < N; ++i) {
      if (std::abs(A(i, k)) > std::abs(A(pivot, k))) pivot = i;
    }
    if (pivot != k) {
      A.row(k).swap(A.row(pivot));
      std::swap(b[k], b[pivot]);
    }
    const double inverse = 1 / A(k, k);
    for (int i = k + 1; i < N; ++i) {
      const double factor = A(i, k) * inverse;
      for (int j = k + 1; j < N; ++j) A(i, j) -= factor * A(k, j);  // eq. (1)
      b[i] -= factor * b[k];
    }
  }
  for (int k = N - 1; k >= 0; --k) {
    for (int j = k + 1; j < N; ++j) b[k] -= A(k, j) * b[j];  // eq. (2)
    b[k] /= A(k, k);
  }
}

}  // namespace flexarm::solvers
