/// @file
/// Mass, damping and stiffness of a System as three sparse matrices of one pattern.
///
/// Rows and columns are the unknowns; the constraints Φ_q stand beside the stiffness,
///
///     M,   C,   K = [∂r/∂x  s Φ_qᵀ; s Φ_q  0]                                                       (1)
///
/// so that any tangent of a time step is a sum of their entries, one by one.
#pragma once

#include <vector>

#include "flexarm/assembly/system.hpp"

namespace flexarm::assembly {

template <int D>
class TangentPartsIn {
 public:
  using Matrix = Eigen::SparseMatrix<double>;

  explicit TangentPartsIn(const SystemIn<D>& system) : system_(system) {}

  /// Equation (1) at a state; laws respond with the memory that it holds.
  void assemble(const StateIn<D>& state, const LoadsIn<D>& loads, double constraint_scale, bool friction);

  const Matrix& M() const { return M_; }
  const Matrix& C() const { return C_; }
  const Matrix& K() const { return K_; }

  /// Calls visit(first, count, block) for every group of columns that share their rows: those of a node,
  /// then the others one by one. Entries of the group lie behind one another from `block` on.
  template <class Visit>
  void visit_columns(Visit&& visit) const {
    const int* start = K_.outerIndexPtr();
    for (int j = 0; j < K_.cols();) {
      const int count = j < system_.scalar_offset() ? geometry::freedoms<D> : 1;
      visit(j, count, start[j], (start[j + count] - start[j]) / count);
      j += count;
    }
  }

 private:
  const SystemIn<D>& system_;
  std::vector<int> slots_;  // where the k-th emitted number goes
  Matrix M_, C_, K_;
};

}  // namespace flexarm::assembly
