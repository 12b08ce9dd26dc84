/// @file
/// LU factors of a sparse matrix whose pattern stays while its numbers change: analyse once, refactor often.
///
/// KLU (SuiteSparse) where the build has it, Eigen's SparseLU otherwise. KLU keeps its pivots from one set of
/// numbers to the next and pivots anew when their growth tells that it must. Who solves for rows has them
/// eliminated by triangular_factors.hpp, for as long as KLU's pivots serve.
#pragma once

#include <Eigen/SparseCore>
#include <memory>

namespace flexarm::linear_solvers {

class SparseFactor {
 public:
  SparseFactor();
  ~SparseFactor();
  SparseFactor(SparseFactor&&) noexcept;
  SparseFactor& operator=(SparseFactor&&) noexcept;

  /// Factors a compressed square matrix. The first call fixes the pattern, which may only grow later.
  /// @return false if the matrix is singular to working precision, or not finite.
  bool factor(const Eigen::SparseMatrix<double>& matrix);

  /// x := A⁻¹ x for every column, in place.
  void solve(Eigen::Ref<Eigen::VectorXd> x) const;
  void solve(Eigen::MatrixXd& X) const;
  /// The same for columns that are stored by rows: substitution then runs along whole rows.
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  void solve(Rows& X) const;

  int factorisations() const { return factorisations_; }

  /// "KLU" or "Eigen SparseLU".
  static const char* backend();

 private:
  struct Backend;
  std::unique_ptr<Backend> backend_;
  Eigen::Index entries_ = 0;
  int factorisations_ = 0;
};

}  // namespace flexarm::linear_solvers
