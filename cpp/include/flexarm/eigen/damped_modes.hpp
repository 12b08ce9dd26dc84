/// @file
/// Eigenvalues of the damped problem, started from the undamped modes:
///
///     (μ² M + μ C + K) x + Φ_qᵀ λ = 0,   Φ_q x = 0                                                  (1)
///
/// First (1) is solved in the subspace of the undamped modes, then each μ is refined by Newton's method on
/// the full quadratic problem, so that a strong damper in one joint is right too. Source: [Ruhe1973].
#pragma once

#include "flexarm/eigen/eigenmodes.hpp"

namespace flexarm::eigen {

/// For each of the first `count` undamped modes the eigenvalue μ, Im μ >= 0, that it turns into [1/s].
/// @param X undamped modes of unit modal mass, one a column; @param omega_squared their ω².
Eigen::VectorXcd damped_eigenvalues(const Eigen::VectorXd& omega_squared, const Eigen::MatrixXd& X,
                                    const SparseMatrix& K, const SparseMatrix& C, const SparseMatrix& M,
                                    const SparseMatrix& J, Eigen::Index count);

}  // namespace flexarm::eigen
