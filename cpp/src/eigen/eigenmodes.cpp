#include "flexarm/eigen/eigenmodes.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "flexarm/dense.hpp"
#include "flexarm/eigen/damped_modes.hpp"
#include "flexarm/errors.hpp"
#include "flexarm/interrupt.hpp"
#include "flexarm/linear_solvers/saddle_point.hpp"
#include "flexarm/linear_solvers/sparse_factor.hpp"

namespace flexarm::eigen {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Added to ω² so that rigid-body modes can be iterated on: (1 rad/s)², below any frequency of interest.
constexpr double shift = 1.0;
// Up to so many motions all modes are found at once, which knows what has no mass; beyond, by iteration.
constexpr Eigen::Index dense_limit = 300;
constexpr double massless = 1e-15;
constexpr int max_turns = 200;
constexpr double rest_change = 1e-11;
// Fine meshes have a floor: ω² carries the rounding of the stiffest element. A change below this that no
// longer shrinks is that floor.
constexpr double floor_limit = 1e-4;

MatrixXd random_start(Eigen::Index n, Eigen::Index p) {
  std::mt19937 generator(1);  // the same start every time: results do not vary from run to run
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(n, p, [&] { return normal(generator); });
}

/// Solutions of M x = ν (K + shift M) x on Φ_q x = 0, ν = 1/(ω² + shift) falling; massless motions (ν = 0)
/// left out.
struct Solutions {
  VectorXd nu;
  MatrixXd X;
  int iterations = 1;
  double residual = 0;
};

/// Eigenvectors of (A, B) in a basis. @throws NotConverged unless B is positive definite
dense::Eigenpairs ritz(const MatrixXd& A, const MatrixXd& B) {
  if (!dense::is_positive_definite(B)) {
    throw NotConverged("modes: the equilibrium is unstable: its stiffness is negative", 0, 0, 0);
  }
  return dense::eigenpairs(A, B);
}

/// All of them at once, in a basis of the null space of J.
Solutions solve_dense(const SparseMatrix& K, const SparseMatrix& M, const SparseMatrix& J) {
  const Eigen::Index n = K.rows();
  const MatrixXd Z = J.rows() > 0 ? dense::null_space(MatrixXd(J)) : MatrixXd(MatrixXd::Identity(n, n));
  const auto solver = ritz(Z.transpose() * (M * Z), Z.transpose() * (K * Z));
  const VectorXd nu = solver.values.reverse();
  const Eigen::Index n_massive = (nu.array() > massless * nu[0]).count();
  return {nu.head(n_massive), (Z * solver.vectors.rowwise().reverse()).leftCols(n_massive)};
}

/// The first `wanted` of them, and some more to speed it up, by subspace iteration.
Solutions solve_by_subspace(const SparseMatrix& K, const SparseMatrix& M, const SparseMatrix& J,
                            Eigen::Index wanted) {
  const Eigen::Index n = K.rows();
  const Eigen::Index p = std::max<Eigen::Index>(2 * wanted, wanted + 8);
  linear_solvers::SparseFactor factor;
  if (!factor.factor(linear_solvers::saddle_point<double>(K, J))) {
    throw NotConverged(
        "modes: the stiffness matrix is singular: a coordinate with neither mass nor stiffness?", 0, 0, 0);
  }
  Solutions found{VectorXd::Zero(p), random_start(n, p)};
  MatrixXd Y = MatrixXd::Zero(n + J.rows(), p);
  for (; found.iterations <= max_turns; ++found.iterations) {
    check_interrupt();
    Y.topRows(n) = M * found.X;
    Y.bottomRows(J.rows()).setZero();
    factor.solve(Y);
    const MatrixXd Q = dense::orthonormal(Y.topRows(n));
    const auto solver = ritz(Q.transpose() * (M * Q), Q.transpose() * (K * Q));
    const VectorXd next = solver.values.reverse();
    found.X = Q * solver.vectors.rowwise().reverse();
    const double change =
        ((next - found.nu).head(wanted).array() / next.head(wanted).array()).abs().maxCoeff();
    found.nu = next;
    const bool at_floor = change < floor_limit && change > 0.5 * found.residual;
    found.residual = change;
    if (change < rest_change || at_floor) return found;
  }
  throw NotConverged(
      "modes: subspace iteration has not converged after " + std::to_string(max_turns) + " turns", 0,
      max_turns, found.residual);
}

}  // namespace

Eigenmodes eigenmodes(const SparseMatrix& K_raw, const SparseMatrix& C, const SparseMatrix& M,
                      const SparseMatrix& J, int count) {
  if (count < 1)
    throw InvalidParameter("the number of modes must be at least 1, got " + std::to_string(count));
  const Eigen::Index n_motions = K_raw.rows() - J.rows();
  Eigenmodes modes;
  if (n_motions <= 0) return modes;
  // At an equilibrium K is symmetric along Φ_q x = 0; elsewhere its antisymmetric part does not matter.
  const SparseMatrix K = 0.5 * (K_raw + SparseMatrix(K_raw.transpose()));
  const SparseMatrix shifted = K + shift * M;
  Solutions found = n_motions <= dense_limit
                        ? solve_dense(shifted, M, J)
                        : solve_by_subspace(shifted, M, J, std::min<Eigen::Index>(count, n_motions));
  if (found.nu.size() == 0) return modes;  // nothing has mass
  for (Eigen::Index k = 0; k < found.X.cols(); ++k) {
    found.X.col(k) /= std::sqrt(found.X.col(k).dot(M * found.X.col(k)));
  }
  const Eigen::Index wanted = std::min<Eigen::Index>(count, found.nu.size());
  modes.iterations = found.iterations;
  modes.residual = found.residual;
  modes.omega_squared = found.nu.cwiseInverse().array() - shift;
  if (C.nonZeros() > 0) {
    const Eigen::Index used = std::min(found.nu.size(), std::max<Eigen::Index>(2 * wanted, wanted + 8));
    modes.damped =
        damped_eigenvalues(modes.omega_squared.head(used), found.X.leftCols(used), K, C, M, J, wanted);
  }
  modes.omega_squared.conservativeResize(wanted);
  modes.shapes = found.X.leftCols(wanted);
  return modes;
}

}  // namespace flexarm::eigen
