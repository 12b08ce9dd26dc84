/// @file
/// The pattern of a sparse matrix whose numbers are told in an order that never changes.
#pragma once

#include <Eigen/SparseCore>
#include <algorithm>
#include <vector>

namespace flexarm::assembly {

struct Pattern {
  Eigen::SparseMatrix<double> matrix;  ///< n x n, compressed, with an entry for each place that is told
  std::vector<int> slots;              ///< where in its values the k-th number goes

  Pattern() = default;
  /// @param emit calls its argument with the row, the column and the value of each number
  template <class Emit>
  Pattern(int n, Emit&& emit) : matrix(n, n) {
    std::vector<Eigen::Triplet<double>> entries;
    emit([&](int row, int column, double) { entries.emplace_back(row, column, 1.0); });
    matrix.setFromTriplets(entries.begin(), entries.end());
    matrix.makeCompressed();
    slots.reserve(entries.size());
    const int* rows = matrix.innerIndexPtr();
    for (const auto& entry : entries) {
      const int* first = rows + matrix.outerIndexPtr()[entry.col()];
      const int* last = rows + matrix.outerIndexPtr()[entry.col() + 1];
      slots.push_back(static_cast<int>(std::lower_bound(first, last, entry.row()) - rows));
    }
  }
};

}  // namespace flexarm::assembly
