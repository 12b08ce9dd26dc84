#include "flexarm/assembly/iteration_matrix.hpp"

#include <algorithm>

namespace flexarm::assembly {

void IterationMatrix::find_pattern(const State& state, const Loads& loads, const TangentFactors& factors,
                                   const VectorXd& law_tangents) {
  std::vector<Eigen::Triplet<double>> entries;
  system_.emit_tangent(state, loads, factors, law_tangents,
                       [&](int row, int column, double) { entries.emplace_back(row, column, 1.0); });
  const int n = system_.n_unknowns();
  matrix_.resize(n, n);
  matrix_.setFromTriplets(entries.begin(), entries.end());
  matrix_.makeCompressed();
  slots_.reserve(entries.size());
  for (const auto& entry : entries) {
    const int* first = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[entry.col()];
    const int* last = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[entry.col() + 1];
    slots_.push_back(static_cast<int>(std::lower_bound(first, last, entry.row()) - matrix_.innerIndexPtr()));
  }
}

}  // namespace flexarm::assembly
