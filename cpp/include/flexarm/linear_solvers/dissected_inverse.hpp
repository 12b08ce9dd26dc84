/// @file
/// Inverse of a matrix that a few separators cut into small parts: what a solve costs if it is the last of
/// thousands.
///
/// With parts p that do not touch one another and the separator s between them
/// (linear_solvers/dissection.hpp),
///
///     A = [A_pp  A_ps; A_sp  A_ss],    S = A_ss − Σ A_sp A_pp⁻¹ A_ps                                (1)
///     x_s = S⁻¹ (b_s − Σ A_sp A_pp⁻¹ b_p)                                                           (2)
///     x_p = A_pp⁻¹ b_p − A_pp⁻¹ A_ps x_s                                                            (3)
///
/// All the matrices of (2), (3) are formed once. A solve is then a few products of small dense matrices,
/// which run through memory in order, where substitution in sparse triangles waits at every pivot for the one
/// before. It multiplies more numbers: for a chain n (m + 2 b) + (n b/m)², with parts of m and boundaries of
/// b unknowns, so it suits up to a few hundred unknowns.
///
/// Before all that go unknowns i whose pivot outweighs the rest of its row and of its column, as amplitudes
/// of inner modes have it at steps longer than their periods. Those that do not touch one another leave
///
///     A'_jk = A_jk − A_ji A_ik/A_ii,   b'_j = b_j − A_ji b_i/A_ii,   x_i = (b_i − Σ A_ik x_k)/A_ii  (4)
///
/// to the parts. Left among them, they would tie parts together and make pieces of multipliers alone.
///
/// Pivots are otherwise looked for inside the parts only. Whether that was good enough is tried on a solution
/// that is known; if not, fewer and larger parts are tried.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "flexarm/linear_solvers/packed_matrix.hpp"

namespace flexarm::linear_solvers {

class DissectedInverse {
 public:
  /// @return false if some part is singular or the inverse loses more than half of the digits.
  bool invert(const Eigen::SparseMatrix<double>& A);

  /// x := A⁻¹ x
  void solve(Eigen::VectorXd& x);

  using MatrixXd = Eigen::MatrixXd;
  using VectorXd = Eigen::VectorXd;

  struct Part {
    Eigen::Index first, size;    // of its unknowns in the new order
    std::vector<int> boundary;   // unknowns of the separator that it touches
    PackedMatrix inverse;        // A_pp⁻¹, and below it A_sp A_pp⁻¹
    PackedMatrix from_boundary;  // A_pp⁻¹ A_ps
    VectorXd product;            // of `inverse`
    VectorXd beyond, from_it;    // x_s on the boundary, and its product with `from_boundary`
  };

  const std::vector<Part>& parts() const { return parts_; }
  const PackedMatrix& separator() const { return separator_; }  ///< S⁻¹
  const std::vector<int>& order() const { return order_; }      ///< parts one after the other, then s
  bool eliminates_first() const { return !leaves_.empty(); }    ///< whether some go by (4)

 private:
  /// An unknown of (4), with its row and column over its pivot.
  struct Leaf {
    struct Entry {
      int other;
      double in_row, in_column;
    };
    int unknown;
    double per_pivot;
    std::vector<Entry> entries;
  };

  std::vector<Leaf> find_leaves(const Eigen::SparseMatrix<double>& A) const;
  Eigen::SparseMatrix<double> without_leaves(const Eigen::SparseMatrix<double>& A);
  void invert_cut(const Eigen::SparseMatrix<double>& A, int part_size);
  bool solves(const Eigen::SparseMatrix<double>& whole);
  void reorder(const Eigen::SparseMatrix<double>& A, int part_size);
  void solve_rest(VectorXd& x);
  void eliminate(Part& part, const MatrixXd& A, MatrixXd& schur) const;

  std::vector<Leaf> leaves_;
  std::vector<int> rest_;  // all unknowns but the leaves; empty without leaves
  std::vector<int> order_;
  std::vector<Part> parts_;
  Eigen::Index n_separated_ = 0;
  PackedMatrix separator_;
  VectorXd b_, x_s_;  // scratch
};

}  // namespace flexarm::linear_solvers
