/// @file
/// The matrix of a constrained problem, [A, s Jᵀ; s J, 0], with s of the size of A's diagonal.
#pragma once

#include <Eigen/SparseCore>
#include <algorithm>
#include <vector>

namespace flexarm::linear_solvers {

template <class Scalar>
Eigen::SparseMatrix<Scalar> saddle_point(const Eigen::SparseMatrix<Scalar>& A,
                                         const Eigen::SparseMatrix<double>& J) {
  double s = 0;
  for (int k = 0; k < A.rows(); ++k) s = std::max(s, std::abs(A.coeff(k, k)));
  std::vector<Eigen::Triplet<Scalar>> entries;
  const auto n = static_cast<int>(A.rows());
  for (int k = 0; k < A.outerSize(); ++k)
    for (typename Eigen::SparseMatrix<Scalar>::InnerIterator it(A, k); it; ++it) {
      entries.emplace_back(static_cast<int>(it.row()), k, it.value());
    }
  for (int k = 0; k < J.outerSize(); ++k)
    for (Eigen::SparseMatrix<double>::InnerIterator it(J, k); it; ++it) {
      const int row = n + static_cast<int>(it.row());
      entries.emplace_back(row, k, Scalar(s * it.value()));
      entries.emplace_back(k, row, Scalar(s * it.value()));
    }
  Eigen::SparseMatrix<Scalar> S(n + J.rows(), n + J.rows());
  S.setFromTriplets(entries.begin(), entries.end());
  return S;
}

}  // namespace flexarm::linear_solvers
