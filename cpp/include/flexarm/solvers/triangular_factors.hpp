/// @file
/// LU factors in the open, L U + F = R⁻¹ P A Q: of one diagonal block of a matrix after the other, F being
/// what lies beside the blocks, R a scale of each row.
///
/// Where the pattern and the pivots stay, the elimination of new numbers needs neither search nor memory:
///
///     u_jk = x_j,  x −= u_jk l_j  for every j < k of column k of U,   u_kk = x_k,  l_ik = x_i/u_kk    (1)
///
/// from x = column k of R⁻¹ P A Q, with columns of U in an order in which each u_jk is final when its turn
/// comes. That is KLU's own refactorisation without its new scale, its estimates of growth and condition and
/// the copy that follows: a third of its time for some twenty unknowns. Source: [Davis2010], section 4.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

namespace flexarm::solvers {

class TriangularFactors {
 public:
  /// Columns of entries; the diagonal is the first of L's columns and the last of U's.
  struct Part {
    std::vector<int> start, row;
    std::vector<double> value;

    void resize(int n, int entries);
  };
  Part L, U, F;
  std::vector<int> P, Q;      ///< row and column of A that come k-th
  std::vector<int> blocks;    ///< where blocks begin, and n
  std::vector<double> scale;  ///< of the k-th row

  void resize(int n, int l_entries, int u_entries, int f_entries, int n_blocks);

  /// Equation (1) for another matrix of the pattern of the first one that came here.
  /// @return false if the pivots do not serve it; the factors are then spoilt.
  bool refactor(const Eigen::SparseMatrix<double>& A);

  /// X := A⁻¹ X of n rows and m columns, stored by rows.
  void solve(double* X, Eigen::Index m);

 private:
  void find_places(const Eigen::SparseMatrix<double>& A);
  void scatter(const Eigen::SparseMatrix<double>& A, int k);

  std::vector<int> place_;                            // of each entry of A: a row, or −1 − that entry of F
  std::vector<double> weight_;                        // 1/scale of its row
  std::vector<double> x_;                             // a column of (1), zero between two
  std::vector<double> per_scale_, per_pivot_, rows_;  // of a solution
};

}  // namespace flexarm::solvers
