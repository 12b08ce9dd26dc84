/// @file
/// Numeric Cholesky factor in supernodes, multifrontal: each supernode adds what its children leave over to
/// its own columns of A, eliminates them, and leaves the rest to its parent,
///
///     [F11  .  ]   [L11    ] [L11ᵀ L21ᵀ]   [0  .]
///     [F21  F22] = [L21  1 ] [      1  ] + [0  U],   U = F22 − L21 L21ᵀ                              (1)
///
/// so that nearly all work is one product per supernode. Source: [Liu1992].
#pragma once

#include <Eigen/Core>
#include <cstdlib>
#include <memory>
#include <vector>

#include "flexarm/linear_solvers/supernodes.hpp"

namespace flexarm::linear_solvers {

/// The least pivot as a part of the diagonal of A, L_jj²/A_jj.
struct LeastPivot {
  double part = 1;
  Eigen::Index column = 0;  ///< of A
};

class SupernodalFactor {
 public:
  /// Ends early, with a least pivot of zero, less or not a number, where a pivot is not positive. Refers to
  /// `nodes`.
  SupernodalFactor(const LowerTriangle& A, const Supernodes& nodes);

  const LeastPivot& least_pivot() const { return least_pivot_; }

  /// X := A⁻¹ X.
  void solve(Eigen::Ref<Eigen::MatrixXd> X) const;

 private:
  class Fronts;
  struct Free {
    void operator()(double* p) const { std::free(p); }
  };
  using Memory = std::unique_ptr<double[], Free>;

  void scatter(const LowerTriangle& A);
  void solve_together(Eigen::Ref<Eigen::MatrixXd> X, int width) const;

  const Supernodes& nodes_;
  std::vector<std::ptrdiff_t> start_;  // of each supernode's columns, diagonal block on top
  Memory L_;
  LeastPivot least_pivot_;
};

}  // namespace flexarm::linear_solvers
