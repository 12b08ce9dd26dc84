#include "flexarm/solvers/increment.hpp"

#include <algorithm>

namespace flexarm::solvers {

void move(const System& system, const Eigen::Ref<const VectorXd>& dx, State& state) {
  for (int n = 0; n < system.n_nodes(); ++n) {
    state.frames[n] = state.frames[n] * geometry::exp6(dx.segment<6>(6 * n));
  }
  const int n_scalars = system.n_free() - system.scalar_offset();
  state.s.head(n_scalars) += dx.segment(system.scalar_offset(), n_scalars);
}

double increment_norm(const System& system, const Eigen::Ref<const VectorXd>& dx) {
  double largest = 0;
  const double per_length = 1 / system.reach();
  for (int n = 0; n < system.n_nodes(); ++n) {
    largest = std::max(largest, per_length * dx.segment<3>(6 * n).cwiseAbs().maxCoeff());
    largest = std::max(largest, dx.segment<3>(6 * n + 3).cwiseAbs().maxCoeff());
  }
  for (int k = system.scalar_offset(); k < system.n_free(); ++k) largest = std::max(largest, std::abs(dx[k]));
  return largest;
}

}  // namespace flexarm::solvers
