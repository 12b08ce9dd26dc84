/// @file
/// Lowest modes of a large symmetric pair by block Lanczos on the inverse:
///
///     K φ = λ M φ,   φᵀ M φ = 1                                                                      (1)
///     A Q_j = Q_1 H_1j + ... + Q_j H_jj + Q_j+1 B_j,   A = K⁻¹ M,   Qᵀ M Q = 1                        (2)
///     H s = θ s:   λ ≈ 1/θ,   φ ≈ Q s,   ‖A φ − θ φ‖_M = ‖B_j s_j‖                                   (3)
///     |λ − λ*|/λ* ≤ ‖λ A φ − φ‖_M   for an exact λ*                                                  (4)
///
/// Every new block is orthogonalised against all before it, so that no mode appears twice. A random
/// start of p vectors reaches every eigenvalue of multiplicity up to p (with probability one). Where p or
/// more values lie together, the search is repeated from a fresh start in the complement of what was found,
/// until that finds nothing more. Source: [Grimes1994]; (4): [Parlett1998] section 4.5, with the inverse.
#pragma once

#include <functional>

#include "flexarm/linear_solvers/lower_triangle.hpp"

namespace flexarm::eigen {

struct LanczosOptions {
  int count = 0;            ///< lowest modes wanted; ignored where max_lambda is positive
  double max_lambda = 0;    ///< all modes up to this λ
  int block = 8;            ///< p
  double tolerance = 1e-7;  ///< on (3), in parts of θ
  unsigned seed = 1;        ///< of the start: equal input gives equal output
};

struct LanczosModes {
  Eigen::VectorXd lambda;    ///< rising
  Eigen::MatrixXd shapes;    ///< columns φ
  Eigen::VectorXd residual;  ///< bound (4) of each mode, computed with A itself
  double next_lambda = 0;    ///< the first one left out, to some percent at worst; infinite if there is none
  int steps = 0;             ///< applications of A to a block
};

/// X = K⁻¹ F, symmetric and at least semi-definite.
using Flexibility = std::function<Eigen::MatrixXd(const Eigen::MatrixXd& F)>;

/// `progress` hears the converged part of the wanted modes and may throw to end the work.
/// @throws NotConverged if rounding keeps (3) above the tolerance.
LanczosModes block_lanczos(const Flexibility& flexibility, const linear_solvers::LowerTriangle& M,
                           const LanczosOptions& options,
                           const std::function<void(double)>& progress = nullptr);

}  // namespace flexarm::eigen
