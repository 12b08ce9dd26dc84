/// @file
/// Decompositions and products of dense matrices, compiled once: each decomposition takes a compiler as long
/// as a whole file of mechanics.
///
///     A = V diag(λ) Vᵀ,   A V = B V diag(λ) with Vᵀ B V = I,   A = U diag(σ) Vᵀ                       (1)
///
/// Eigenvalues rise, singular values fall. An eigenvalue problem throws NotConverged where its matrix is not
/// finite, or its iteration finds no end.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace flexarm::dense {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Eigenpairs {
  VectorXd values;
  MatrixXd vectors;
};

/// Equation (1) of a symmetric matrix, whose lower triangle is read.
Eigenpairs eigenpairs(const MatrixXd& A);
VectorXd eigenvalues(const MatrixXd& A);

/// Equation (1) of a symmetric matrix beside a positive definite one.
Eigenpairs eigenpairs(const MatrixXd& A, const MatrixXd& B);

struct ComplexEigenpairs {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;
};

/// A V = V diag(λ) of any square matrix, in no order.
ComplexEigenpairs general_eigenpairs(const MatrixXd& A);

bool is_positive_definite(const MatrixXd& A);

/// σ and all of V in (1).
struct RightSingular {
  VectorXd values;
  MatrixXd vectors;
};
RightSingular right_singular(const MatrixXd& A);

/// Tᵀ A T.
MatrixXd congruent(const MatrixXd& A, const MatrixXd& T);

/// A⁻¹, by elimination with row pivots.
MatrixXd inverse(const MatrixXd& A);

/// The shortest X of the least |A X − B|. A pivot below the tolerance, as a share of the largest, counts as
/// zero; by default that of rounding.
MatrixXd least_squares(const MatrixXd& A, const MatrixXd& B, std::optional<double> rank_tolerance = {});

/// Number of independent columns of A, with the same tolerance.
Eigen::Index rank(const MatrixXd& A, double tolerance);

/// Orthonormal columns that span those of A.
MatrixXd orthonormal(const MatrixXd& A);

/// Orthonormal columns z with A z = 0.
MatrixXd null_space(const MatrixXd& A);

}  // namespace flexarm::dense
