#include "flexarm/eigen/damped_modes.hpp"

#include <Eigen/SparseLU>
#include <cmath>
#include <complex>
#include <vector>

#include "flexarm/dense.hpp"
#include "flexarm/linear_solvers/saddle_point.hpp"

namespace flexarm::eigen {
namespace {

/// Newton's method on (1) from (μ, x).
std::complex<double> refine(std::complex<double> mu, Eigen::VectorXcd x, const SparseMatrix& K,
                            const SparseMatrix& C, const SparseMatrix& M, const SparseMatrix& J) {
  using Complex = std::complex<double>;
  const Eigen::Index n = K.rows();
  const Eigen::SparseMatrix<Complex> Kc = K.cast<Complex>(), Cc = C.cast<Complex>(), Mc = M.cast<Complex>();
  const Eigen::VectorXcd weight = x / x.squaredNorm();
  for (int turn = 0; turn < 12; ++turn) {
    const Eigen::SparseMatrix<Complex> T = mu * mu * Mc + mu * Cc + Kc;
    if (!std::isfinite(std::abs(T.sum()))) return mu;
    Eigen::SparseLU<Eigen::SparseMatrix<Complex>> factor(linear_solvers::saddle_point<Complex>(T, J));
    if (factor.info() != Eigen::Success) return mu;  // T is singular: μ is exact
    Eigen::VectorXcd rhs = Eigen::VectorXcd::Zero(n + J.rows());
    rhs.head(n) = (2.0 * mu * Mc + Cc) * x;
    const Eigen::VectorXcd y = factor.solve(rhs).head(n);
    const Complex step = 1.0 / weight.dot(y);
    if (!std::isfinite(std::abs(step))) return mu;
    x = step * y;
    mu -= step;
    if (std::abs(step) < 1e-12 * std::abs(mu)) break;
  }
  return mu;
}

/// The damped solution, not yet taken and with Im μ >= 0, in which the undamped mode k has its largest share.
Eigen::Index most_like(Eigen::Index k, const Eigen::MatrixXd& share, const Eigen::VectorXcd& mu,
                       const std::vector<bool>& taken) {
  Eigen::Index best = -1;
  double most = -1;
  for (Eigen::Index i = 0; i < mu.size(); ++i) {
    if (taken[static_cast<std::size_t>(i)] || mu[i].imag() < 0) continue;
    const double part = share(k, i) / share.col(i).norm();
    if (part > most) {
      most = part;
      best = i;
    }
  }
  return best;
}

}  // namespace

Eigen::VectorXcd damped_eigenvalues(const Eigen::VectorXd& omega_squared, const Eigen::MatrixXd& X,
                                    const SparseMatrix& K, const SparseMatrix& C, const SparseMatrix& M,
                                    const SparseMatrix& J, Eigen::Index count) {
  const Eigen::Index p = X.cols();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * p, 2 * p);  // first-order form of (1) in the subspace
  A.topRightCorner(p, p).setIdentity();
  A.bottomLeftCorner(p, p).diagonal() = -omega_squared;
  A.bottomRightCorner(p, p) = -X.transpose() * (C * X);
  const auto [values, vectors] = dense::general_eigenpairs(A);
  const Eigen::MatrixXd share = vectors.topRows(p).cwiseAbs();  // of the undamped modes
  std::vector<bool> taken(static_cast<std::size_t>(2 * p), false);
  Eigen::VectorXcd mu(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index own = most_like(k, share, values, taken);
    if (own < 0) return mu.head(k);
    taken[static_cast<std::size_t>(own)] = true;
    const Eigen::VectorXcd x = X * vectors.col(own).head(p);
    mu[k] = refine(values[own], x, K, C, M, J);
  }
  return mu;
}

}  // namespace flexarm::eigen
