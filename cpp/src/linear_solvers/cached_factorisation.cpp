#include "flexarm/linear_solvers/cached_factorisation.hpp"

namespace flexarm::linear_solvers {

bool CachedFactorisation::factor(const Eigen::SparseMatrix<double>& A) {
  if (!sparse_.factor(A)) return false;
  inverted_ = A.rows() <= largest_inverse && inverse_.invert(A);
  return true;
}

void CachedFactorisation::solve(Eigen::VectorXd& x) {
  if (inverted_) {
    inverse_.solve(x);
  } else {
    sparse_.solve(x);
  }
}

}  // namespace flexarm::linear_solvers
