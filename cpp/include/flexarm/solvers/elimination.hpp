/// @file
/// A X = B for a few unknowns and right sides, their number best known when compiled:
/// Gaussian elimination with partial pivoting,
///
///     row_i −= (a_ik/a_kk) row_k,  i > k,  a_kk the largest of what is left of its column             (1)
///     X_k = (B_k − Σ a_kj X_j)/a_kk,  j > k,  with rows X_k, B_k                                     (2)
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

/// Calls column(0), ..., column(n − 1). @param N n, or Eigen::Dynamic
template <int N, class Column>
[[gnu::always_inline]] inline void for_each_column(int n, const Column& column) {
  if constexpr (N >= 0 && N <= most_written_out) {
    [&]<int... k>(std::integer_sequence<int, k...>)
        __attribute__((always_inline)) { (column(k), ...); }(std::make_integer_sequence<int, N>{});
  } else {
    for (int k = 0; k < n; ++k) column(k);
  }
}

/// X replaces B, and A is lost. A singular matrix leaves what is not a finite number.
template <class Square, class RightSides>
void eliminate(Square& A, RightSides& B) {
  constexpr int N = Square::RowsAtCompileTime;
  const int n = N >= 0 ? N : static_cast<int>(A.rows());
  const int columns =
      RightSides::ColsAtCompileTime >= 0 ? RightSides::ColsAtCompileTime : static_cast<int>(B.cols());
  Eigen::Matrix<double, N, 1, 0, Square::MaxRowsAtCompileTime, 1> inverse(n);
  for_each_column<N>(n, [&](int k) __attribute__((always_inline)) {
    int pivot = k;
    double largest = std::abs(A(k, k));
    for (int i = k + 1; i < n; ++i) {
      const double size = std::abs(A(i, k));
      if (size > largest) {
        largest = size;
        pivot = i;
      }
    }
    if (pivot != k) {
      A.row(k).swap(A.row(pivot));
      B.row(k).swap(B.row(pivot));
    }
    inverse[k] = 1 / A(k, k);
    for (int i = k + 1; i < n; ++i) {
      const double factor = A(i, k) * inverse[k];
      for (int j = k + 1; j < n; ++j) A(i, j) -= factor * A(k, j);  // eq. (1)
      for (int j = 0; j < columns; ++j) B(i, j) -= factor * B(k, j);
    }
  });
  for_each_column<N>(n, [&](int from_last) __attribute__((always_inline)) {
    const int k = n - 1 - from_last;
    for (int j = 0; j < columns; ++j) B(k, j) *= inverse[k];
    for (int i = 0; i < k; ++i) {
      for (int j = 0; j < columns; ++j) B(i, j) -= A(i, k) * B(k, j);  // eq. (2), a column at a time
    }
  });
}

}  // namespace flexarm::solvers
