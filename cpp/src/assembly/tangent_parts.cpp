#include "flexarm/assembly/tangent_parts.hpp"

#include <algorithm>

#include "flexarm/assembly/pattern.hpp"
#include "flexarm/assembly/tangent_terms.hpp"

namespace flexarm::assembly {

namespace {

void clear(Eigen::SparseMatrix<double>& matrix) {
  std::fill(matrix.valuePtr(), matrix.valuePtr() + matrix.nonZeros(), 0.0);
}

/// Adds the k-th numbers that are told at the k-th slot.
struct Adding {
  const int* slot;
  double *M, *C, *K;
  double constraint_scale;
  const VectorXd &law_damping, &law_stiffness;

  void add(int, int, double mass, double damping, double stiffness) {
    const int at = *slot++;
    if (M != nullptr) M[at] += mass;
    C[at] += damping;
    K[at] += stiffness;
  }
  void stiffen(int, int, double stiffness) { K[*slot++] += stiffness; }
  void constrain(int, int, double value) { K[*slot++] += constraint_scale * value; }
  void law(std::size_t k, int, int, double sign) {
    const int at = *slot++;
    C[at] += sign * law_damping[static_cast<Eigen::Index>(k)];
    K[at] += sign * law_stiffness[static_cast<Eigen::Index>(k)];
  }
};

}  // namespace

template <int D>
void TangentPartsIn<D>::assemble(const StateIn<D>& state, const LoadsIn<D>& loads, double constraint_scale,
                                 bool friction) {
  const bool first = slots_.empty();
  if (first) {
    const VectorXd none = system_.no_law_tangents();
    Pattern pattern(system_.n_unknowns(),
                    [&](auto&& add) { system_.emit_tangent(state, loads, {1, 1, 1, 1}, none, add); });
    slots_ = std::move(pattern.slots);
    M_ = C_ = K_ = std::move(pattern.matrix);
  }
  const VectorXd damping = system_.law_tangents(state, {0, 1, 0, 0}, friction),
                 stiffness = system_.law_tangents(state, {0, 0, 1, 0}, friction);
  clear(C_);
  clear(K_);
  if (first) clear(M_);  // constant in local frames
  system_.emit_terms(state, loads, {true, true},
                     Adding{slots_.data(), first ? M_.valuePtr() : nullptr, C_.valuePtr(), K_.valuePtr(),
                            constraint_scale, damping, stiffness});
}

template class TangentPartsIn<2>;
template class TangentPartsIn<3>;

}  // namespace flexarm::assembly
