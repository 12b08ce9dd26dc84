#include "flexarm/solvers/eigenmodes.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <random>

#include "flexarm/errors.hpp"
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

/// [A, s Jᵀ; s J, 0], s of the size of A's diagonal.
template <class Scalar>
Eigen::SparseMatrix<Scalar> saddle_point(const Eigen::SparseMatrix<Scalar>& A, const SparseMatrix& J) {
  double s = 0;
  for (int k = 0; k < A.rows(); ++k) s = std::max(s, std::abs(A.coeff(k, k)));
  std::vector<Eigen::Triplet<Scalar>> entries;
  const auto n = static_cast<int>(A.rows());
  for (int k = 0; k < A.outerSize(); ++k)
    for (typename Eigen::SparseMatrix<Scalar>::InnerIterator it(A, k); it; ++it) {
      entries.emplace_back(static_cast<int>(it.row()), k, it.value());
    }
  for (int k = 0; k < J.outerSize(); ++k)
    for (SparseMatrix::InnerIterator it(J, k); it; ++it) {
      const int row = n + static_cast<int>(it.row());
      entries.emplace_back(row, k, Scalar(s * it.value()));
      entries.emplace_back(k, row, Scalar(s * it.value()));
    }
  Eigen::SparseMatrix<Scalar> S(n + J.rows(), n + J.rows());
  S.setFromTriplets(entries.begin(), entries.end());
  return S;
}

MatrixXd random_start(Eigen::Index n, Eigen::Index p) {
  std::mt19937 generator(1);  // the same start every time: results do not vary from run to run
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(n, p, [&] { return normal(generator); });
}

/// Newton's method on (2) from (μ, x).
std::complex<double> refine(std::complex<double> mu, Eigen::VectorXcd x, const SparseMatrix& K,
                            const SparseMatrix& C, const SparseMatrix& M, const SparseMatrix& J) {
  using Complex = std::complex<double>;
  const Eigen::Index n = K.rows();
  const Eigen::SparseMatrix<Complex> Kc = K.cast<Complex>(), Cc = C.cast<Complex>(), Mc = M.cast<Complex>();
  const Eigen::VectorXcd weight = x / x.squaredNorm();
  for (int turn = 0; turn < 12; ++turn) {
    const Eigen::SparseMatrix<Complex> T = mu * mu * Mc + mu * Cc + Kc;
    Eigen::SparseLU<Eigen::SparseMatrix<Complex>> factor(saddle_point<Complex>(T, J));
    if (factor.info() != Eigen::Success) return mu;  // T is singular: μ is exact
    Eigen::VectorXcd rhs = Eigen::VectorXcd::Zero(n + J.rows());
    rhs.head(n) = (2.0 * mu * Mc + Cc) * x;
    const Eigen::VectorXcd y = factor.solve(rhs).head(n);
    const Complex step = 1.0 / weight.dot(y);
    x = step * y;
    mu -= step;
    if (std::abs(step) < 1e-12 * std::abs(mu)) break;
  }
  return mu;
}

Eigen::VectorXcd damped_modes(const Eigenmodes& modes, Eigen::Index count, const MatrixXd& X,
                              const SparseMatrix& K, const SparseMatrix& C, const SparseMatrix& M,
                              const SparseMatrix& J) {
  const Eigen::Index p = X.cols();
  MatrixXd A = MatrixXd::Zero(2 * p, 2 * p);  // first-order form of (2) in the subspace
  A.topRightCorner(p, p).setIdentity();
  A.bottomLeftCorner(p, p).diagonal() = -modes.omega_squared;
  A.bottomRightCorner(p, p) = -X.transpose() * (C * X);
  const Eigen::EigenSolver<MatrixXd> solver(A);
  std::vector<Eigen::Index> upper;
  for (Eigen::Index k = 0; k < 2 * p; ++k) {
    if (solver.eigenvalues()[k].imag() >= 0) upper.push_back(k);
  }
  std::sort(upper.begin(), upper.end(), [&](Eigen::Index a, Eigen::Index b) {
    return std::abs(solver.eigenvalues()[a]) < std::abs(solver.eigenvalues()[b]);
  });
  Eigen::VectorXcd mu(std::min<Eigen::Index>(count, static_cast<Eigen::Index>(upper.size())));
  for (Eigen::Index k = 0; k < mu.size(); ++k) {
    const Eigen::VectorXcd x = X * solver.eigenvectors().col(upper[k]).head(p);
    mu[k] = refine(solver.eigenvalues()[upper[k]], x, K, C, M, J);
  }
  return mu;
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
    modes.damped = damped_modes(modes, wanted, X, unshifted, C, M, J);
  }
  modes.omega_squared.conservativeResize(wanted);
  modes.shapes = X.leftCols(wanted);
  return modes;
}

}  // namespace flexarm::solvers
