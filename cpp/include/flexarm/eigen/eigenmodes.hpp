/// @file
/// Natural modes of a constrained system about an equilibrium:
///
///     (K − ω² M) x + Φ_qᵀ λ = 0,   Φ_q x = 0                                                        (1)
///     (μ² M + μ C + K) x + Φ_qᵀ λ = 0,   ζ = −Re μ/|μ|                                              (2)
///
/// (1) in a basis of the null space of Φ_q where the system is small, by subspace iteration where it is
/// large, with a small shift, so that arms with free joints have their zero frequencies; (2) in
/// damped_modes.hpp. Units: rad/s. Source: [Bathe1982] for the subspace iteration.
#pragma once

#include <Eigen/SparseCore>
#include <complex>

namespace flexarm::eigen {

using SparseMatrix = Eigen::SparseMatrix<double>;

struct Eigenmodes {
  Eigen::VectorXd omega_squared;  ///< rising [rad²/s²]; negative: unstable
  Eigen::MatrixXd shapes;         ///< columns, unit modal mass
  Eigen::VectorXcd damped;        ///< μ of (2), Im μ >= 0, mode by mode [1/s]; empty without damping
  int iterations = 0;
  double residual = 0;  ///< largest relative change of ω² in the last turn
};

/// The `count` lowest modes (fewer if the system has fewer). C may have no entries.
/// @throws NotConverged; also where K is negative, which large systems show only near the modes sought:
/// statics.hpp tests it.
Eigenmodes eigenmodes(const SparseMatrix& K, const SparseMatrix& C, const SparseMatrix& M,
                      const SparseMatrix& J, int count);

}  // namespace flexarm::eigen
