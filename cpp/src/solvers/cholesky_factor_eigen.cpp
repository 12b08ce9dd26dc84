// Stands in for cholesky_factor.cpp where the build has no CHOLMOD.
#include "flexarm/solvers/cholesky_factor.hpp"

#ifndef FLEXARM_HAS_CHOLMOD

#include <Eigen/SparseCholesky>
#include <chrono>

#include "flexarm/interrupt.hpp"
#include "flexarm/solvers/blas_info.hpp"

namespace flexarm::solvers {
namespace {

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

// L D Lᵀ rather than L Lᵀ: it goes on to the end and so tells which pivot is at fault.
struct CholeskyFactor::Backend {
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> ldlt;

  void check(const LowerTriangle& A) const {
    const Eigen::VectorXd pivots = ldlt.vectorD(), own = diagonal(A);
    for (Eigen::Index k = 0; k < pivots.size(); ++k) {
      const Eigen::Index column = ldlt.permutationPinv().indices()[k];
      if (pivots[k] > smallest_pivot * own[column]) continue;
      throw NotPositiveDefinite(
          "a symmetric matrix must be positive definite, row " + std::to_string(column) + " is not", column);
    }
  }
};

CholeskyFactor::CholeskyFactor(const LowerTriangle& A) : backend_(std::make_unique<Backend>()) {
  const double start = seconds();
  backend_->ldlt.analyzePattern(A);
  const double analysed = seconds();
  backend_->ldlt.factorize(A);
  backend_->check(A);
  report_.backend = "Eigen simplicial";
  report_.ordering = "AMD";
  report_.blas = loaded_blas();
  const auto L = backend_->ldlt.matrixL().nestedExpression().outerIndexPtr();
  for (Eigen::Index k = 0; k < A.cols(); ++k) {
    const double below = L[k + 1] - L[k];
    report_.entries += 1 + below;
    report_.operations += (1 + below) * (1 + below);
  }
  report_.entries_amd = report_.entries;
  report_.seconds_ordering = analysed - start;
  report_.seconds_factor = seconds() - analysed;
}

void CholeskyFactor::solve(Eigen::Ref<Eigen::MatrixXd> X) const {
  check_interrupt();
  X = backend_->ldlt.solve(Eigen::MatrixXd(X));
}

bool CholeskyFactor::has_supernodal() { return false; }
bool CholeskyFactor::has_metis() { return false; }

CholeskyFactor::~CholeskyFactor() = default;
CholeskyFactor::CholeskyFactor(CholeskyFactor&&) noexcept = default;
CholeskyFactor& CholeskyFactor::operator=(CholeskyFactor&&) noexcept = default;

}  // namespace flexarm::solvers

#endif
