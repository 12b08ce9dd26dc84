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
#include <utility>

namespace flexarm::solvers {

/// Up to so many unknowns the loop over pivots is written out, so that all others have bounds that the
/// compiler knows; beyond, code grows more than time falls.
inline constexpr int most_written_out = 10;

/// Calls column(0), ..., column(N − 1).
template <int N, class Column>
[[gnu::always_inline]] inline void for_each_column(const Column& column) {
  if constexpr (N <= most_written_out) {
    [&]<int... k>(std::integer_sequence<int, k...>)
        __attribute__((always_inline)) { (column(k), ...); }(std::make_integer_sequence<int, N>{});
  } else {
    for (int k = 0; k < N; ++k) column(k);
  }
}

/// x replaces b, and A is lost. A singular matrix leaves what is not a finite number.
template <int N>
void eliminate(Eigen::Matrix<double, N, N, Eigen::RowMajor>& A, Eigen::Matrix<double, N, 1>& b) {
  double inverse[N];
  for_each_column<N>([&](int k) __attribute__((always_inline)) {
    int pivot = k;
    double largest = std::abs(A(k, k));
    for (int i = k + 1; i < N; ++i) {
      const double size = std::abs(A(i, k));
      if (size > largest) {
        largest = size;
        pivot = i;
      }
    }
    if (pivot != k) {
      A.row(k).swap(A.row(pivot));
      std::swap(b[k], b[pivot]);
    }
    inverse[k] = 1 / A(k, k);
    for (int i = k + 1; i < N; ++i) {
      const double factor = A(i, k) * inverse[k];
      for (int j = k + 1; j < N; ++j) A(i, j) -= factor * A(k, j);  // eq. (1)
      b[i] -= factor * b[k];
    }
  });
  for_each_column<N>([&](int from_last) __attribute__((always_inline)) {
    const int k = N - 1 - from_last;
    b[k] *= inverse[k];
    for (int i = 0; i < k; ++i) b[i] -= A(i, k) * b[k];  // eq. (2), a column at a time
  });
}

}  // namespace flexarm::solvers
