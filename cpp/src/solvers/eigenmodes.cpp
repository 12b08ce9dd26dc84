#include "flexarm/solvers/eigenmodes.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <random>

#include "flexarm/errors.hpp"
#include "flexarm/solvers/damped_modes.hpp"
#include "flexarm/solvers/saddle_point.hpp"
#include "flexarm/solvers/sparse_factor.hpp"

namespace flexarm::solvers {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Added to ω² so that rigid-body modes can be iterated on: (1 rad/s)², below any frequency of interest.
constexpr double shift = 1.0;
constexpr int max_turns = 200;
constexpr double tolerance = 1e-11;
// Fine meshes have a floor: ω² carries the rounding of the stiffest element. A change below this that no
// longer shrinks is that floor.
constexpr double floor_limit = 1e-4;

MatrixXd random_start(Eigen::Index n, Eigen::Index p) {
  std::mt19937 generator(1);  // the same start every time: results do not vary from run to run
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(n, p, [&] { return normal(generator); });
}

}  // namespace

Eigenmodes eigenmodes(const SparseMatrix& K_raw, const SparseMatrix& C, const SparseMatrix& M,
                      const SparseMatrix& J, int count) {
  const Eigen::Index n = K_raw.rows();
  const Eigen::Index n_motions = n - J.rows();
  Eigenmodes modes;
  if (n_motions <= 0) return modes;
  const Eigen::Index wanted = std::min<Eigen::Index>(count, n_motions);
  const Eigen::Index p = std::min<Eigen::Index>(n_motions, std::max<Eigen::Index>(2 * wanted, wanted + 8));
  // Off equilibrium-free directions K is symmetric; its antisymmetric part has no work on Φ_q x = 0.
  const SparseMatrix K = 0.5 * (K_raw + SparseMatrix(K_raw.transpose())) + shift * M;
  SparseFactor factor;
  if (!factor.factor(saddle_point<double>(K, J))) {
    throw NotConverged(
        "modes: the stiffness matrix is singular: a coordinate with neither mass nor stiffness?", 0, 0, 0);
  }
  MatrixXd X = random_start(n, p), Y = MatrixXd::Zero(n + J.rows(), p);
  VectorXd nu = VectorXd::Zero(p);  // 1/(ω² + shift), falling
  for (modes.iterations = 1; modes.iterations <= max_turns; ++modes.iterations) {
    Y.topRows(n) = M * X;
    Y.bottomRows(J.rows()).setZero();
    factor.solve(Y);
    const MatrixXd Q = Eigen::HouseholderQR<MatrixXd>(Y.topRows(n)).householderQ() * MatrixXd::Identity(n, p);
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> ritz(Q.transpose() * (M * Q),
                                                                  Q.transpose() * (K * Q));
    const VectorXd next = ritz.eigenvalues().reverse();
    X = Q * ritz.eigenvectors().rowwise().reverse();
    const double change = ((next - nu).head(wanted).array() / next.head(wanted).array()).abs().maxCoeff();
    nu = next;
    const bool at_floor = change < floor_limit && change > 0.5 * modes.residual;
    modes.residual = change;
    if (change < tolerance || at_floor) break;
  }
  if (modes.iterations > max_turns) {
    throw NotConverged(
        "modes: subspace iteration has not converged after " + std::to_string(max_turns) + " turns", 0,
        max_turns, modes.residual);
  }
  for (Eigen::Index k = 0; k < p; ++k) X.col(k) /= std::sqrt(X.col(k).dot(M * X.col(k)));
  modes.omega_squared = nu.cwiseInverse().array() - shift;
  if (C.nonZeros() > 0) {
    const SparseMatrix unshifted = K - shift * M;
    modes.damped = damped_eigenvalues(modes.omega_squared, X, unshifted, C, M, J, wanted);
  }
  modes.omega_squared.conservativeResize(wanted);
  modes.shapes = X.leftCols(wanted);
  return modes;
}

}  // namespace flexarm::solvers
