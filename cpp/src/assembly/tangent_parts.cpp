#include "flexarm/assembly/tangent_parts.hpp"

#include <algorithm>

namespace flexarm::assembly {

template <int D>
void TangentPartsIn<D>::assemble(const StateIn<D>& state, const LoadsIn<D>& loads, double constraint_scale,
                                 bool friction) {
  const VectorXd none = VectorXd::Zero(static_cast<Eigen::Index>(system_.laws().size()));
  if (slots_.empty()) {
    find_slots(state, loads);
    fill(M_, state, loads, {1, 0, 0, 0}, none);  // constant in local frames
  }
  const TangentFactors damping{0, 1, 0, 0}, stiffness{0, 0, 1, constraint_scale};
  fill(C_, state, loads, damping, system_.law_tangents(state, damping, friction));
  fill(K_, state, loads, stiffness, system_.law_tangents(state, stiffness, friction));
}

template <int D>
void TangentPartsIn<D>::find_slots(const StateIn<D>& state, const LoadsIn<D>& loads) {
  std::vector<Eigen::Triplet<double>> entries;
  const VectorXd none = VectorXd::Zero(static_cast<Eigen::Index>(system_.laws().size()));
  system_.emit_tangent(state, loads, {1, 1, 1, 1}, none,
                       [&](int row, int column, double) { entries.emplace_back(row, column, 1.0); });
  const int n = system_.n_unknowns();
  K_.resize(n, n);
  K_.setFromTriplets(entries.begin(), entries.end());
  K_.makeCompressed();
  slots_.reserve(entries.size());
  for (const auto& entry : entries) {
    const int* first = K_.innerIndexPtr() + K_.outerIndexPtr()[entry.col()];
    const int* last = K_.innerIndexPtr() + K_.outerIndexPtr()[entry.col() + 1];
    slots_.push_back(static_cast<int>(std::lower_bound(first, last, entry.row()) - K_.innerIndexPtr()));
  }
  M_ = C_ = K_;
}

template <int D>
void TangentPartsIn<D>::fill(Matrix& matrix, const StateIn<D>& state, const LoadsIn<D>& loads,
                             const TangentFactors& factors, const VectorXd& law_tangents) {
  double* values = matrix.valuePtr();
  std::fill(values, values + matrix.nonZeros(), 0.0);
  std::size_t k = 0;
  system_.emit_tangent(state, loads, factors, law_tangents,
                       [&](int, int, double value) { values[slots_[k++]] += value; });
}

template class TangentPartsIn<2>;
template class TangentPartsIn<3>;

}  // namespace flexarm::assembly
