/// @file
/// A small dense matrix that is made once and multiplied by thousands of vectors.
///
///     y_i = Σ_j A_ij x_j                                                                             (1)
///
/// Columns lie one after the other, filled up to a multiple of four rows, so that (1) runs over four rows at
/// a time and its sums stay in registers. Each sum adds its products in the order of j, by multiplications
/// and additions of IEEE 754, so it has the same bits whatever vectors the processor knows.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace flexarm::linear_solvers {

class PackedMatrix {
 public:
  static constexpr Eigen::Index lanes = 4;

  PackedMatrix() = default;
  explicit PackedMatrix(const Eigen::MatrixXd& A);

  Eigen::Index rows() const { return rows_; }
  Eigen::Index cols() const { return cols_; }
  double operator()(Eigen::Index i, Eigen::Index j) const { return columns_[j * filled_rows_ + i]; }
  Eigen::Index filled_rows() const { return filled_rows_; }  ///< a multiple of four

  /// Equation (1). @param y has room for filled_rows() entries; those beyond rows() become zero.
  void multiply(const double* x, double* y) const;

 private:
  Eigen::Index rows_ = 0, cols_ = 0, filled_rows_ = 0;
  std::vector<double> columns_;
};

}  // namespace flexarm::linear_solvers
