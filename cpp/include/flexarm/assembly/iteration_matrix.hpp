/// @file
/// The tangent of the equations of motion as a compressed sparse matrix whose pattern is found once: later
/// assemblies only add numbers.
///
/// Entries that are negligible against their row and column stay out of the pattern. A plane arm thus falls
/// into its motion in the plane and across it, which halves the factors. An entry that grows later joins the
/// pattern; Newton's iteration does not depend on the entries left out, for its residual is exact.
#pragma once

#include <vector>

#include "flexarm/assembly/equations.hpp"

namespace flexarm::assembly {

template <int D>
class IterationMatrixIn {
 public:
  explicit IterationMatrixIn(const SystemIn<D>& system) : system_(system) {}

  /// The pattern of the result changes from one call to the next only by growing.
  /// @return null if a number is not finite; the pattern stays as it was
  const Eigen::SparseMatrix<double>* assemble(const StateIn<D>& state, const LoadsIn<D>& loads,
                                              const TangentFactors& factors, const VectorXd& law_tangents);

  /// The next pattern is that of the next numbers, whatever came before.
  void forget();

 private:
  bool significant_entries_join();
  void compress();

  const SystemIn<D>& system_;
  Eigen::SparseMatrix<double> full_;  // all entries that are emitted
  std::vector<int> slots_;            // where in it the k-th emitted number goes
  std::vector<bool> kept_;            // which of its entries are in the pattern
  Eigen::SparseMatrix<double> matrix_;
};

using IterationMatrix = IterationMatrixIn<3>;

}  // namespace flexarm::assembly
