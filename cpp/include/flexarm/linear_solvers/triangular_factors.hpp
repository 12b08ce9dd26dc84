/// @file
/// LU factors in the open, L U + F = R⁻¹ P A Q: of one diagonal block of a matrix after the other, F being
/// what lies beside the blocks, R a scale of each row.
///
/// Where the pattern and the pivots stay, the elimination of new numbers needs neither search nor memory:
/// from x = R⁻¹ P A Q, for one pivot k after the other,
///
///     u_kj = x_kj,   l_ik = x_ik/u_kk,   x_ij −= l_ik u_kj   for all i, j > k of the pattern           (1)
///
/// Which numbers the products of (1) meet is found once and told by a list. Those of one pivot do not wait
/// for one another, as they would column by column. KLU's own refactorisation scales anew, estimates growth
/// and condition and is followed by a copy. Source: [Davis2010], section 4.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

namespace flexarm::linear_solvers {

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
  /// value[target] −= value[u] value[l]
  struct Product {
    int target, u, l;
  };

  bool find_places(const Eigen::SparseMatrix<double>& A);
  bool find_products();
  int place(int row, int column, int first_of_block) const;

  // Of U, of L behind them and of F are the entries that work_ holds.
  std::vector<int> place_;          // of each entry of A
  std::vector<double> weight_;      // 1/scale of its row
  std::vector<Product> products_;   // of (1), pivot after pivot
  std::vector<int> first_product_;  // of a pivot, and of the one behind the last
  std::vector<double> work_;
  std::vector<double> per_scale_, per_pivot_, rows_;  // of a solution
};

}  // namespace flexarm::linear_solvers
