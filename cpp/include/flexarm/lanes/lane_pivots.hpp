/// @file
/// Pivots of linear_solvers/elimination.hpp for matrices of numbers side by side, of which each lane has its
/// own.
#pragma once

#include "flexarm/linear_solvers/elimination.hpp"

namespace flexarm::lanes {

template <class Real>
struct LanePivots {
  Real *row, *inverse;
  void resize(int) const {}
};

template <class Matrix, class Real>
void exchange_rows(Matrix& B, const LanePivots<Real>& pivots, int k) {
  const Real row = pivots.row[k];
  if (Real(row - k).magnitude().all_below(0.5)) return;
  if (Real(row - row[0]).magnitude().all_below(0.5)) {  // all lanes alike
    const int other = static_cast<int>(row[0]);
    for (int j = 0; j < B.cols(); ++j) {
      const Real number = B(k, j);
      B(k, j) = B(other, j);
      B(other, j) = number;
    }
    return;
  }
  for (int lane = 0; lane < Real::lanes; ++lane) {
    const int other = static_cast<int>(row[lane]);
    for (int j = 0; j < B.cols() && other != k; ++j) {
      const double number = B(k, j)[lane];
      B(k, j).set(lane, B(other, j)[lane]);
      B(other, j).set(lane, number);
    }
  }
}

template <class Square, class Real>
void bring_pivot(Square& A, LanePivots<Real>& pivots, int k, int n) {
  Real row = k, largest = A(k, k).magnitude();
  for (int i = k + 1; i < n; ++i) {
    const Real size = A(i, k).magnitude();
    const Real is_larger = Real(largest - size).ones_below(0);
    row = Real(i).where(is_larger) + row.where(1 - is_larger);
    largest = Real::larger(size, largest);
  }
  pivots.row[k] = row;
  exchange_rows(A, pivots, k);
}

}  // namespace flexarm::lanes
