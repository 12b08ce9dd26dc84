/// @file
/// A part whose interface frames are held: K_ii of the freedoms that follow no rigid interface, factored
/// once, and average interfaces as constraints on it,
///
///     K u + Wᵀ λ = f,   W u = g,   u = 0 where a rigid interface holds it                             (1)
///     u = G f − Y λ + R c,   G = K_ii⁻¹,   Y = G Wᵀ                                                  (2)
///     [S  −Z; −Zᵀ  0] (λ, c) = (W G f − g, −Rᵀ f),   S = W Y,   Z = W R                               (3)
///
/// If a rigid interface holds the part, there is no c. If none does, six isostatic freedoms are grounded for
/// the factor; since (3) balances f − Wᵀ λ, nothing acts on that ground, and R c restores the rigid motion:
/// (2) is exact. Six unknowns an average interface, six more for c.
#pragma once

#include <Eigen/LU>
#include <memory>

#include "flexarm/linear_solvers/cholesky_factor.hpp"
#include "flexarm/reduction/support.hpp"

namespace flexarm::reduction {

class FixedInterface {
 public:
  /// @throws InvalidParameter naming the freedom if K_ii is singular, or the interfaces if (3) is.
  FixedInterface(const linear_solvers::LowerTriangle& K, const Coordinates& coordinates,
                 const std::vector<Interface>& interfaces, const InterfaceMaps& maps, const Support& support);

  /// u of (1) for every column of forces F, with frames held still (g = 0).
  Eigen::MatrixXd solve(const Eigen::MatrixXd& F) const;
  /// The same with average interfaces displaced by the columns of g.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& F, const Eigen::MatrixXd& g) const;

  /// Freedoms that are not held.
  Eigen::Index n_inner() const { return static_cast<Eigen::Index>(inner_.size()); }
  const linear_solvers::CholeskyReport& report() const { return factor_->report(); }

 private:
  Eigen::MatrixXd solve_unconstrained(const Eigen::MatrixXd& F) const;  // G F
  void border(const std::vector<Interface>& interfaces);

  std::vector<int> inner_;  // freedoms of K_ii
  std::unique_ptr<const linear_solvers::CholeskyFactor> factor_;
  const Eigen::SparseMatrix<double>& Wt_;
  Eigen::MatrixXd R_, Y_;  // R without columns if a rigid interface holds the part
  Eigen::VectorXd scale_;  // brings the entries of (3) to one size
  Eigen::FullPivLU<Eigen::MatrixXd> border_;
};

}  // namespace flexarm::reduction
