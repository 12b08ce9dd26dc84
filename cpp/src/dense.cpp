#include "flexarm/dense.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cstddef>

#include "flexarm/errors.hpp"
#include "flexarm/linear_solvers/blas_info.hpp"

namespace flexarm::dense {
namespace {

/// Eigen's iterations give any numbers, and no error, for a matrix that is not finite.
const MatrixXd& finite(const MatrixXd& A) {
  if (!A.allFinite()) throw NotConverged("a matrix of an eigenvalue problem is not finite", 0, 0, 0);
  return A;
}

template <class Solver>
const Solver& converged(const Solver& solver) {
  if (solver.info() != Eigen::Success || !solver.eigenvalues().allFinite())
    throw NotConverged("an eigenvalue problem has no solution", 0, 0, 0);
  return solver;
}

// From this size on LAPACK takes a fifth of the time of Eigen.
constexpr Eigen::Index large = 64;

/// By divide and conquer, where LAPACK is loaded; no values otherwise.
Eigenpairs by_lapack(const MatrixXd& A) {
  // The lengths of Fortran's strings come last.
  using Function = void(const char*, const char*, const int*, double*, const int*, double*, double*,
                        const int*, int*, const int*, int*, std::size_t, std::size_t);
  static auto* const dsyevd = reinterpret_cast<Function*>(linear_solvers::blas_symbol("dsyevd_"));
  if (dsyevd == nullptr) return {};
  const int n = static_cast<int>(A.rows()), n_work = 1 + 6 * n + 2 * n * n, n_integers = 3 + 5 * n;
  Eigenpairs pairs{VectorXd(n), A};
  VectorXd work(n_work);
  Eigen::VectorXi integers(n_integers);
  int info = 0;
  const linear_solvers::OneBlasThread here;
  dsyevd("V", "L", &n, pairs.vectors.data(), &n, pairs.values.data(), work.data(), &n_work, integers.data(),
         &n_integers, &info, 1, 1);
  if (info != 0 || !pairs.values.allFinite()) return {};
  return pairs;
}

template <class Decomposition>
Decomposition decomposed(const MatrixXd& A, std::optional<double> rank_tolerance) {
  Decomposition decomposition;
  if (rank_tolerance) decomposition.setThreshold(*rank_tolerance);
  decomposition.compute(A);
  return decomposition;
}

}  // namespace

Eigenpairs eigenpairs(const MatrixXd& A) {
  if (A.rows() >= large) {
    Eigenpairs pairs = by_lapack(finite(A));
    if (pairs.values.size() > 0) return pairs;
  }
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(finite(A));
  converged(solver);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

VectorXd eigenvalues(const MatrixXd& A) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(finite(A), Eigen::EigenvaluesOnly);
  return converged(solver).eigenvalues();
}

Eigenpairs eigenpairs(const MatrixXd& A, const MatrixXd& B) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(finite(A), finite(B));
  converged(solver);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

ComplexEigenpairs general_eigenpairs(const MatrixXd& A) {
  const Eigen::EigenSolver<MatrixXd> solver(finite(A));
  converged(solver);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

bool is_positive_definite(const MatrixXd& A) { return Eigen::LLT<MatrixXd>(A).info() == Eigen::Success; }

RightSingular right_singular(const MatrixXd& A) {
  const Eigen::JacobiSVD<MatrixXd> solver(A, Eigen::ComputeFullV);
  return {solver.singularValues(), solver.matrixV()};
}

MatrixXd congruent(const MatrixXd& A, const MatrixXd& T) { return T.transpose() * A * T; }

MatrixXd inverse(const MatrixXd& A) { return Eigen::PartialPivLU<MatrixXd>(A).inverse(); }

MatrixXd least_squares(const MatrixXd& A, const MatrixXd& B, std::optional<double> rank_tolerance) {
  return decomposed<Eigen::CompleteOrthogonalDecomposition<MatrixXd>>(A, rank_tolerance).solve(B);
}

Eigen::Index rank(const MatrixXd& A, double tolerance) {
  return decomposed<Eigen::ColPivHouseholderQR<MatrixXd>>(A, tolerance).rank();
}

MatrixXd orthonormal(const MatrixXd& A) {
  return Eigen::HouseholderQR<MatrixXd>(A).householderQ() * MatrixXd::Identity(A.rows(), A.cols());
}

MatrixXd null_space(const MatrixXd& A) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(MatrixXd(A.transpose()));
  return MatrixXd(qr.householderQ()).rightCols(A.cols() - qr.rank());
}

}  // namespace flexarm::dense
