/// @file
/// A X = B for a few unknowns and right sides, their number best known when compiled:
/// Gaussian elimination with partial pivoting,
///
///     P A = L U:   l_ik = a_ik/a_kk,  row_i −= l_ik row_k,  i > k,  a_kk the largest of what is left of its
///                  column                                                                            (1)
///     Y_i = B_i − Σ l_ik Y_k,  k < i,   with the rows of B in the order of P                         (2)
///     X_k = (Y_k − Σ u_kj X_j)/u_kk,  j > k                                                          (3)
///
/// Eigen's factorisation has sizes of run time within, which takes longer than the elimination itself where
/// it is done once a step. Source: [Golub2013], section 3.4.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <utility>

namespace flexarm::linear_solvers {

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

/// What belongs to L U in the place of A. @param most rows there may be
///
/// Numbers side by side, each with its own pivots, have them in lanes/lane_pivots.hpp.
template <int most>
struct Pivots {
  Eigen::Matrix<int, Eigen::Dynamic, 1, 0, most, 1> row;         ///< that came in the place of row k, k ≤ row
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1> inverse;  ///< 1/u_kk

  void resize(int n) {
    row.resize(n);
    inverse.resize(n);
  }
};

/// Row k of B changes places with the one that has its pivot.
template <class Matrix, int most>
[[gnu::always_inline]] inline void exchange_rows(Matrix& B, const Pivots<most>& pivots, int k) {
  if (pivots.row[k] != k) B.row(k).swap(B.row(pivots.row[k]));
}

/// Brings the pivot of column k into its place.
template <class Square, int most>
[[gnu::always_inline]] inline void bring_pivot(Square& A, Pivots<most>& pivots, int k, int n) {
  int pivot = k;
  double largest = std::abs(A(k, k));
  for (int i = k + 1; i < n; ++i) {
    const double size = std::abs(A(i, k));
    if (size > largest) {
      largest = size;
      pivot = i;
    }
  }
  pivots.row[k] = pivot;
  exchange_rows(A, pivots, k);
}

/// Equation (1), in place. A singular matrix leaves what is not a finite number.
template <class Square, class PivotsOf>
void factor_in_place(Square& A, PivotsOf& pivots) {
  constexpr int N = Square::RowsAtCompileTime;
  const int n = N >= 0 ? N : static_cast<int>(A.rows());
  pivots.resize(n);
  for_each_column<N>(n, [&](int k) __attribute__((always_inline)) {
    bring_pivot(A, pivots, k, n);
    const auto inverse = pivots.inverse[k] = 1 / A(k, k);
    for (int i = k + 1; i < n; ++i) {
      const auto factor = A(i, k) *= inverse;
      for (int j = k + 1; j < n; ++j) A(i, j) -= factor * A(k, j);
    }
  });
}

/// Equations (2) and (3); X replaces B.
template <class Square, class PivotsOf, class RightSides>
void substitute(const Square& LU, const PivotsOf& pivots, RightSides& B) {
  constexpr int N = Square::RowsAtCompileTime;
  const int n = N >= 0 ? N : static_cast<int>(LU.rows());
  const int columns =
      RightSides::ColsAtCompileTime >= 0 ? RightSides::ColsAtCompileTime : static_cast<int>(B.cols());
  for (int k = 0; k < n; ++k) exchange_rows(B, pivots, k);
  for_each_column<N>(n, [&](int k) __attribute__((always_inline)) {
    for (int i = k + 1; i < n; ++i) {
      for (int j = 0; j < columns; ++j) B(i, j) -= LU(i, k) * B(k, j);
    }
  });
  for_each_column<N>(n, [&](int from_last) __attribute__((always_inline)) {
    const int k = n - 1 - from_last;
    for (int j = 0; j < columns; ++j) B(k, j) *= pivots.inverse[k];
    for (int i = 0; i < k; ++i) {
      for (int j = 0; j < columns; ++j) B(i, j) -= LU(i, k) * B(k, j);
    }
  });
}

/// X replaces B, and A is lost.
template <class Square, class RightSides>
void eliminate(Square& A, RightSides& B) {
  Pivots<Square::MaxRowsAtCompileTime> pivots;
  factor_in_place(A, pivots);
  substitute(A, pivots, B);
}

}  // namespace flexarm::linear_solvers
