#include "flexarm/integrators/increment.hpp"

#include <algorithm>

namespace flexarm::integrators {

template <int D>
void move(const SystemIn<D>& system, const Eigen::Ref<const VectorXd>& dx, StateIn<D>& state) {
  constexpr int n = geometry::freedoms<D>;
  for (int k = 0; k < system.n_nodes(); ++k) {
    state.frames[k] = state.frames[k] * geometry::exponential<D>(dx.segment<n>(n * k));
  }
  const int n_scalars = system.n_free() - system.scalar_offset();
  state.s.head(n_scalars) += dx.segment(system.scalar_offset(), n_scalars);
}

template <int D>
[[gnu::flatten]] void move_nodes(const std::vector<int>& nodes,
                                 const std::vector<geometry::FrameIn<D>>& before, const VectorXd& exponent,
                                 std::vector<geometry::FrameIn<D>>& after) {
  constexpr int n = geometry::freedoms<D>;
  using geometry::Two;
  std::size_t at = 0;
  for (; at + 1 < nodes.size(); at += 2) {  // two nodes at a time
    const int first = nodes[at], second = nodes[at + 1];
    geometry::Twist<D, Two> h;
    for (int i = 0; i < n; ++i) h[i] = Two(exponent[n * first + i], exponent[n * second + i]);
    const auto H =
        geometry::side_by_side<D>(before[first], before[second]) * geometry::exponential<D, Two>(h);
    after[first] = geometry::lane<D>(H, 0);
    after[second] = geometry::lane<D>(H, 1);
  }
  if (at < nodes.size()) {
    const int k = nodes[at];
    after[k] = before[k] * geometry::exponential<D>(exponent.template segment<n>(n * k));
  }
}

template <int D>
double increment_norm(const SystemIn<D>& system, const Eigen::Ref<const VectorXd>& dx) {
  constexpr int n = geometry::freedoms<D>, turns = geometry::turns<D>;
  double translation = 0, rest = 0;
  for (int k = 0; k < system.n_nodes(); ++k) {
    translation = std::max(translation, dx.segment<D>(n * k).cwiseAbs().maxCoeff());
    rest = std::max(rest, dx.segment<turns>(n * k + D).cwiseAbs().maxCoeff());
  }
  for (int k = system.scalar_offset(); k < system.n_free(); ++k) rest = std::max(rest, std::abs(dx[k]));
  return std::max(translation / system.reach(), rest);
}

template <int D>
void remember_laws(const SystemIn<D>& system, StateIn<D>& state) {
  for (std::size_t k = 0; k < state.laws.size(); ++k) {
    const auto& law = system.laws()[k];
    const double x = system.deflection(law, state.s);
    double z = 0;
    if (!joints::acts_at_rest(law.law)) {  // friction alone has an internal state
      z = system.respond(k, state).z;
    }
    state.laws[k] = {x, z};
  }
}

template void remember_laws<2>(const SystemIn<2>&, StateIn<2>&);
template void remember_laws<3>(const SystemIn<3>&, StateIn<3>&);
template void move<2>(const SystemIn<2>&, const Eigen::Ref<const VectorXd>&, StateIn<2>&);
template void move<3>(const SystemIn<3>&, const Eigen::Ref<const VectorXd>&, StateIn<3>&);
template void move_nodes<2>(const std::vector<int>&, const std::vector<geometry::FrameIn<2>>&,
                            const VectorXd&, std::vector<geometry::FrameIn<2>>&);
template double increment_norm<2>(const SystemIn<2>&, const Eigen::Ref<const VectorXd>&);
template void move_nodes<3>(const std::vector<int>&, const std::vector<geometry::FrameIn<3>>&,
                            const VectorXd&, std::vector<geometry::FrameIn<3>>&);
template double increment_norm<3>(const SystemIn<3>&, const Eigen::Ref<const VectorXd>&);

}  // namespace flexarm::integrators
