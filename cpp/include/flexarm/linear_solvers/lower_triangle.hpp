/// @file
/// Symmetric matrices stored by their lower triangle, compressed columns with sorted rows.
#pragma once

#include <Eigen/SparseCore>

namespace flexarm::linear_solvers {

/// A reference: the matrix is not copied.
using LowerTriangle = Eigen::Ref<const Eigen::SparseMatrix<double>>;

/// A X with the whole symmetric matrix A.
Eigen::MatrixXd multiply(const LowerTriangle& A, const Eigen::Ref<const Eigen::MatrixXd>& X);

inline Eigen::VectorXd diagonal(const LowerTriangle& A) {
  Eigen::VectorXd d = Eigen::VectorXd::Zero(A.cols());
  for (Eigen::Index j = 0; j < A.cols(); ++j) {
    const LowerTriangle::InnerIterator first(A, j);
    if (first && first.row() == j) d[j] = first.value();
  }
  return d;
}

}  // namespace flexarm::linear_solvers
