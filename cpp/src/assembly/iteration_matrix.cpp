#include "flexarm/assembly/iteration_matrix.hpp"

#include <algorithm>
#include <cmath>

#include "flexarm/assembly/pattern.hpp"
#include "flexarm/assembly/tangent_terms.hpp"

namespace flexarm::assembly {
namespace {

// Beside the largest entries of its row and column, an entry below this does not matter to the iteration.
constexpr double negligible = 1e-12;

}  // namespace

template <int D>
const Eigen::SparseMatrix<double>* IterationMatrixIn<D>::assemble(const StateIn<D>& state,
                                                                  const LoadsIn<D>& loads,
                                                                  const TangentFactors& factors,
                                                                  const VectorXd& law_tangents) {
  const auto emit = [&](auto&& add) { system_.emit_tangent(state, loads, factors, law_tangents, add); };
  if (slots_.empty()) {
    Pattern pattern(system_.n_unknowns(), emit);
    full_ = std::move(pattern.matrix);
    slots_ = std::move(pattern.slots);
    kept_.assign(static_cast<std::size_t>(full_.nonZeros()), false);
  }
  double* values = full_.valuePtr();
  std::fill(values, values + full_.nonZeros(), 0.0);
  std::size_t k = 0;
  emit([&](int, int, double value) { values[slots_[k++]] += value; });
  if (!std::isfinite(full_.coeffs().sum())) return nullptr;  // as is the sum of what is not
  const bool grown = significant_entries_join();
  if (grown || matrix_.rows() == 0) matrix_.resize(full_.rows(), full_.cols());
  compress();
  return &matrix_;
}

template <int D>
void IterationMatrixIn<D>::forget() {
  slots_.clear();
  matrix_ = {};
}

/// Adds to the pattern what matters in the present numbers. @return whether it has grown
template <int D>
bool IterationMatrixIn<D>::significant_entries_join() {
  VectorXd largest = VectorXd::Zero(full_.rows());  // in row or column; the pattern is symmetric
  using Entry = Eigen::SparseMatrix<double>::InnerIterator;
  for (int column = 0; column < full_.outerSize(); ++column) {
    for (Entry it(full_, column); it; ++it) {
      const double size = std::abs(it.value());
      largest[it.row()] = std::max(largest[it.row()], size);
      largest[column] = std::max(largest[column], size);
    }
  }
  bool grown = false;
  std::size_t k = 0;
  for (int column = 0; column < full_.outerSize(); ++column) {
    for (Entry it(full_, column); it; ++it, ++k) {
      const double scale = std::sqrt(largest[it.row()]) * std::sqrt(largest[column]);
      if (kept_[k] || !(std::abs(it.value()) > negligible * scale)) continue;
      kept_[k] = grown = true;
    }
  }
  return grown;
}

/// Copies the entries of the pattern from the full matrix.
template <int D>
void IterationMatrixIn<D>::compress() {
  const bool new_pattern = matrix_.nonZeros() == 0;
  if (new_pattern) matrix_.reserve(std::count(kept_.begin(), kept_.end(), true));
  const double* values = full_.valuePtr();
  double* out = matrix_.valuePtr();
  std::size_t k = 0;
  for (int column = 0; column < full_.outerSize(); ++column) {
    if (new_pattern) matrix_.startVec(column);
    for (Eigen::SparseMatrix<double>::InnerIterator it(full_, column); it; ++it, ++k) {
      if (!kept_[k]) continue;
      if (new_pattern) {
        matrix_.insertBack(it.row(), column) = values[k];
      } else {
        *out++ = values[k];
      }
    }
  }
  if (new_pattern) matrix_.finalize();
}

template class IterationMatrixIn<2>;
template class IterationMatrixIn<3>;

}  // namespace flexarm::assembly
