/// @file
/// The tangent of a System as a compressed sparse matrix whose pattern is found once: later assemblies only
/// add numbers.
#pragma once

#include <algorithm>
#include <vector>

#include "flexarm/assembly/system.hpp"

namespace flexarm::assembly {

class IterationMatrix {
 public:
  explicit IterationMatrix(const System& system) : system_(system) {}

  const Eigen::SparseMatrix<double>& assemble(const State& state, const Loads& loads,
                                              const TangentFactors& factors, const VectorXd& law_tangents) {
    if (slots_.empty()) find_pattern(state, loads, factors, law_tangents);
    double* values = matrix_.valuePtr();
    std::fill(values, values + matrix_.nonZeros(), 0.0);
    std::size_t k = 0;
    system_.emit_tangent(state, loads, factors, law_tangents,
                         [&](int, int, double value) { values[slots_[k++]] += value; });
    return matrix_;
  }

 private:
  void find_pattern(const State& state, const Loads& loads, const TangentFactors& factors,
                    const VectorXd& law_tangents);

  const System& system_;
  Eigen::SparseMatrix<double> matrix_;
  std::vector<int> slots_;  // where the k-th emitted number goes
};

}  // namespace flexarm::assembly
