/// @file
/// Error estimates of a reduced part. With fixed-interface modes φ_k (unit modal mass, K φ = λ M φ) and the
/// rigid motions R about the centre of mass:
///
///     m_k = (φ_kᵀ M R)²                                effective modal mass, six directions           (1)
///     Σ m_k = Rᵀ M M_ii⁻¹ M R over all modes           what can move against held interfaces          (2)
///
/// For free modes u_j = T y_j of the reduced part, K̂ y = λ̂ M̂ y with unit modal mass, the residuals
/// r_j = K u_j − λ̂_j M u_j have no part along the modes kept. They drive those left out only, each by
/// (φ_kᵀ r)²/(λ_k − λ̂) <= (φ_kᵀ r)²/λ_k /(1 − λ̂/λ_left). Condensing them to second order,
///
///     λ ≈ spectrum of diag(λ̂) − S E S,   E_ij = r_iᵀ G r_j,   S = diag(1 − λ̂/λ_left)^−½               (3)
///
/// with the flexibility G of the part with held interfaces and λ_left the first mode left out, for modes
/// below f_left/1.5 only: S grows without bound towards f_left. The matrix, not its diagonal alone, because
/// close frequencies mix. What (3) leaves of λ̂ is the error stated to the user, and
///
///     f_trust = min(f_left/1.5, min f̂_j (1 − e_j) over all j with e_j > 1 %)                        (4)
///
/// with the free frequencies f̂_j and their relative errors e_j. Source: [Girard2008] for (1); (3) is the
/// estimate of [Kim2014] with the factor at hand instead of the residual flexibility alone.
#pragma once

#include "flexarm/reduction/fixed_interface.hpp"

namespace flexarm::reduction {

struct ReductionQuality {
  double left_out_frequency_hz = 0;                   ///< of the first mode left out; infinite if none is
  double trusted_frequency_hz = 0;                    ///< eq. (4)
  double mass = 0;                                    ///< of the part [kg]
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();   ///< of mass [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about it [kg m²]
  Eigen::MatrixXd effective_mass;        ///< (mode, 6) eq. (1): x, y, z [kg], about x, y, z [kg m²]
  Eigen::VectorXd movable_mass;          ///< (6) eq. (2)
  Eigen::VectorXd mode_residual;         ///< bound on the relative error of λ_k
  Eigen::VectorXd free_frequency_hz;     ///< of the reduced part without supports, below f_left/1.5
  Eigen::VectorXd free_frequency_error;  ///< how much each lies above the full part's, relative, from (3)
  double rigid_body_correction = 0;      ///< of the interface stiffness, relative
};

/// Mass, centre and inertia; effective masses (1) and (2).
void compute_mass_properties(const linear_solvers::LowerTriangle& M, const Coordinates& coordinates,
                             const InterfaceMaps& maps, const Support& support, const Eigen::MatrixXd& shapes,
                             ReductionQuality& quality);

/// Free frequencies of the reduced part, their errors (3) and what may be trusted (4).
void estimate_errors(const linear_solvers::LowerTriangle& K, const linear_solvers::LowerTriangle& M,
                     const FixedInterface& part, const Eigen::MatrixXd& T, const Eigen::MatrixXd& stiffness,
                     const Eigen::MatrixXd& mass, double left_out_lambda, ReductionQuality& quality);

}  // namespace flexarm::reduction
