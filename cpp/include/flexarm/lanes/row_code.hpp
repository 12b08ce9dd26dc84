/// @file
/// Numbers of arms side by side as values: rows, matrices of them, and products. Included once for each kind
/// of processor.
#pragma once

#include "flexarm/lanes/numbers.hpp"
#include "flexarm/simd/pack.hpp"

namespace flexarm::lanes {

/// The matrix whose first row of numbers is the k-th.
template <class Matrix>
Matrix matrix(const double* rows, int k) {
  using Real = typename Matrix::Scalar;
  Matrix m;
  for (int i = 0; i < Matrix::SizeAtCompileTime; ++i) m.data()[i] = Real::at(rows + Real::lanes * (k + i));
  return m;
}

/// The same where each lane has a row of its own, so many rows behind.
template <class Matrix>
Matrix matrix_by_lane(const double* rows, int k, int step, const int* places) {
  using Real = typename Matrix::Scalar;
  Matrix m;
  for (int i = 0; i < Matrix::SizeAtCompileTime; ++i) {
    Real number;
    for (int lane = 0; lane < Real::lanes; ++lane) {
      number.set(lane, rows[Real::lanes * (k + i + step * places[lane]) + lane]);
    }
    m.data()[i] = number;
  }
  return m;
}

template <int N, class Processor>
class RowCode {
 protected:
  using Real = geometry::Pack<N, Processor>;

  static Real at(const double* rows, int k) { return Real::at(rows + N * k); }
  static void put(double* rows, int k, const Real& value) { value.put(rows + N * k); }
  static void add(double* rows, int k, const Real& value) { put(rows, k, at(rows, k) + value); }

  template <class Matrix>
  static void put_matrix(double* rows, int k, const Matrix& m) {
    for (int i = 0; i < Matrix::SizeAtCompileTime; ++i) put(rows, k + i, m.data()[i]);
  }
  template <class Matrix>
  static void add_matrix(double* rows, int k, const Matrix& m) {
    for (int i = 0; i < Matrix::SizeAtCompileTime; ++i) add(rows, k + i, m.data()[i]);
  }

  /// y := A x of a matrix by blocks of rows.
  template <int Rows>
  [[gnu::always_inline]] static void multiply_block(const double*& numbers, int columns, const double* x,
                                                    double* y) {
    Real sum[Rows];
    for (int i = 0; i < Rows; ++i) sum[i] = 0.0;
    for (int j = 0; j < columns; ++j, numbers += N * Rows) {
      const Real x_j = at(x, j);
      for (int i = 0; i < Rows; ++i) sum[i] += at(numbers, i) * x_j;
    }
    for (int i = 0; i < Rows; ++i) put(y, i, sum[i]);
  }
  static void multiply(const double* numbers, int rows, int columns, const double* x, double* y) {
    for (; rows >= block_rows; rows -= block_rows, y += N * block_rows) {
      multiply_block<block_rows>(numbers, columns, x, y);
    }
    switch (rows) {
      case 5:
        return multiply_block<5>(numbers, columns, x, y);
      case 4:
        return multiply_block<4>(numbers, columns, x, y);
      case 3:
        return multiply_block<3>(numbers, columns, x, y);
      case 2:
        return multiply_block<2>(numbers, columns, x, y);
      case 1:
        return multiply_block<1>(numbers, columns, x, y);
      default:
        return;
    }
  }
};

}  // namespace flexarm::lanes
