/// @file
/// Cholesky factor of a sparse symmetric positive definite matrix, for many right-hand sides:
///
///     P A Pᵀ = L Lᵀ                                                                                 (1)
///
/// P is the fill-reducing ordering of fill_ordering.hpp; L is held in the supernodes of supernodes.hpp, dense
/// kernels by the loaded BLAS.
#pragma once

#include <memory>
#include <string>

#include "flexarm/errors.hpp"
#include "flexarm/linear_solvers/lower_triangle.hpp"

namespace flexarm::linear_solvers {

/// A pivot of the factorisation is negative, or zero to working precision.
struct NotPositiveDefinite : InvalidParameter {
  NotPositiveDefinite(const std::string& message, Eigen::Index at_column)
      : InvalidParameter(message), column(at_column) {}
  Eigen::Index column;  ///< of A
};

/// How a factor came about.
struct CholeskyReport {
  std::string backend;       ///< "supernodal"
  std::string ordering;      ///< "METIS" or "AMD"
  std::string blas;          ///< as loaded_blas() tells
  double entries = 0;        ///< of L
  double entries_amd = 0;    ///< of L in the ordering of AMD
  double entries_metis = 0;  ///< of L in that of METIS; 0 where there is none
  double operations = 0;     ///< floating-point operations of the factorisation
  double seconds_ordering = 0, seconds_factor = 0;
};

class CholeskyFactor {
 public:
  /// @throws NotPositiveDefinite if a pivot is not positive, or below 1e-13 of its diagonal entry.
  explicit CholeskyFactor(const LowerTriangle& A);
  ~CholeskyFactor();
  CholeskyFactor(CholeskyFactor&&) noexcept;
  CholeskyFactor& operator=(CholeskyFactor&&) noexcept;

  /// X := A⁻¹ X.
  void solve(Eigen::Ref<Eigen::MatrixXd> X) const;

  const CholeskyReport& report() const { return report_; }

 private:
  struct Backend;
  CholeskyReport report_;
  std::unique_ptr<Backend> backend_;
};

/// A pivot below this part of its diagonal entry is rounding: the matrix is singular.
inline constexpr double smallest_pivot = 1e-13;

}  // namespace flexarm::linear_solvers
