/// @file
/// A factorisation that serves thousands of right sides before it is made anew. The inverse of a matrix that
/// is not large is formed (linear_solvers/dissected_inverse.hpp).
///
/// The choice depends on the matrix alone, so the same one always gives the same solution to the last bit.
#pragma once

#include "flexarm/linear_solvers/dissected_inverse.hpp"
#include "flexarm/linear_solvers/sparse_factor.hpp"

namespace flexarm::linear_solvers {

class CachedFactorisation {
 public:
  /// Matrices of up to so many unknowns are inverted; beyond, substitution is faster.
  static constexpr Eigen::Index largest_inverse = 160;

  /// @return false if the matrix is singular to working precision.
  bool factor(const Eigen::SparseMatrix<double>& A);

  /// x := A⁻¹ x
  void solve(Eigen::VectorXd& x);
  /// The inverse; null where it was not formed.
  const DissectedInverse* inverse() const { return inverted_ ? &inverse_ : nullptr; }
  /// The same factors for those who solve a few times only.
  const SparseFactor& by_substitution() const { return sparse_; }

 private:
  SparseFactor sparse_;
  DissectedInverse inverse_;
  bool inverted_ = false;
};

}  // namespace flexarm::linear_solvers
