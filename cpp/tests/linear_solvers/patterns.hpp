/// @file
/// Sparse symmetric positive definite matrices for tests of factorisations: random ones and such of one
/// shape.
#pragma once

#include <Eigen/SparseCore>
#include <algorithm>
#include <vector>

#include "numerics.hpp"

namespace flexarm::tests {

using SparseMatrix = Eigen::SparseMatrix<double>;
using Edges = std::vector<std::pair<int, int>>;

/// Lower triangle of a matrix whose points couple along `edges`, each point of `freedoms` unknowns that all
/// couple. Off-diagonal entries are random; the diagonal exceeds the sum of its row by a random part of it.
inline SparseMatrix matrix_of(const Edges& edges, const std::vector<int>& freedoms, Random& random) {
  std::vector<int> first = {0};
  for (const int f : freedoms) first.push_back(first.back() + f);
  const int n = first.back();
  MatrixXd A = MatrixXd::Zero(n, n);
  const auto couple = [&](int p, int q) {
    for (int i = first[p]; i < first[p + 1]; ++i)
      for (int j = first[q]; j < first[q + 1]; ++j)
        if (i != j) A(std::max(i, j), std::min(i, j)) = random(0.1, 1) * (random(-1, 1) < 0 ? -1 : 1);
  };
  for (int p = 0; p < static_cast<int>(freedoms.size()); ++p) couple(p, p);
  for (const auto& [p, q] : edges) couple(p, q);
  const MatrixXd sizes = A.cwiseAbs();
  A.diagonal() = (sizes.rowwise().sum() + sizes.colwise().sum().transpose()) * random(1.01, 1.5);
  A.diagonal().array() += 1e-3;
  return A.sparseView();
}

/// Up to 40 points of one to three unknowns; about `neighbours` edges at each point, often more than one
/// piece.
inline SparseMatrix random_matrix(Random& random, double neighbours) {
  const int n = static_cast<int>(random(1, 41));
  std::vector<int> freedoms(static_cast<std::size_t>(n));
  for (int& f : freedoms) f = static_cast<int>(random(1, 4));
  Edges edges;
  for (int p = 0; p < n; ++p)
    for (int q = 0; q < p; ++q)
      if (random(0, 1) < neighbours / n) edges.emplace_back(p, q);
  return matrix_of(edges, freedoms, random);
}

inline MatrixXd full(const SparseMatrix& A) { return MatrixXd(A).selfadjointView<Eigen::Lower>(); }

}  // namespace flexarm::tests
