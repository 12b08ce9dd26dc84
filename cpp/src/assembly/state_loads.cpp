#include "flexarm/assembly/state_loads.hpp"

#include "flexarm/assembly/equations.hpp"

namespace flexarm::assembly {

using namespace geometry;

namespace {

/// Forces (2) of a stress K b p of a beam in the deformation d.
template <int D>
elements::TwoTwists<D> against(const Twist<D>& d, const Twist<D>& stress) {
  const auto pair = InverseTangentIn<D>(d).transpose_times(stress);
  elements::TwoTwists<D> f;
  f << pair.left, -pair.right;
  return f;
}

template <int D>
Twist<D> chord(const elements::BeamElementIn<D>& beam, const StateIn<D>& state) {
  return logarithm<D>(relative<D>(state.frames[beam.node1()], state.frames[beam.node2()]));
}

}  // namespace

template <int D>
typename RestStrainIn<D>::Ends RestStrainIn<D>::forces(const Beam& of, const StateIn<D>& state) const {
  const Twist<D> stress = table.at(state).y * of.stiffness().cwiseProduct(strain);
  return against<D>(chord(of, state), stress);  // eq. (2)
}

template <int D>
auto RestStrainIn<D>::tangent(const Beam& of, const StateIn<D>& state, bool moving) const
    -> StateTangentIn<D, 2 * n> {
  const Twist<D> d = chord(of, state), unit = of.stiffness().cwiseProduct(strain);
  const auto p = table.at(state);
  const auto geometric = geometric_stiffness<D>(d, Twist<D>(p.y * unit));
  Eigen::Matrix<double, n, 2 * n> B;
  B << -left_tangent_inverse<D>(d), right_tangent_inverse<D>(d);
  StateTangentIn<D, 2 * n> found;
  found.stiffness.template topRows<n>() = geometric.left.lazyProduct(B);
  found.stiffness.template bottomRows<n>() = -geometric.right.lazyProduct(B);
  if (moving) found.by_y = p.first * against<D>(d, unit);
  return found;
}

template <int D>
Twist<D> StateForceIn<D>::forces(const StateIn<D>& state) const {
  const elements::WeightIn<D> unit{1, place};
  return -table.at(state).y * unit.force(state.frames[node].R, force);  // eq. (3)
}

template <int D>
auto StateForceIn<D>::tangent(const StateIn<D>& state, bool moving) const -> StateTangentIn<D, n> {
  const elements::WeightIn<D> unit{1, place};
  const Rotation<D>& R = state.frames[node].R;
  const auto p = table.at(state);
  StateTangentIn<D, n> found;
  found.stiffness = p.y * unit.stiffness(R, force);
  if (moving) found.by_y = -p.first * unit.force(R, force);
  return found;
}

template <int D>
void add_state_loads(const SystemIn<D>& system, const StateIn<D>& state, VectorXd& r) {
  constexpr int n = freedoms<D>;
  for (const RestStrainIn<D>& load : system.rest_strains()) {
    const auto& beam = system.beams()[load.beam];
    const elements::TwoTwists<D> f = load.forces(beam, state);
    r.template segment<n>(n * beam.node1()) += f.template head<n>();
    r.template segment<n>(n * beam.node2()) += f.template tail<n>();
  }
  for (const StateForceIn<D>& load : system.state_forces())
    r.template segment<n>(n * load.node) += load.forces(state);
}

template struct RestStrainIn<2>;
template struct RestStrainIn<3>;
template struct StateForceIn<2>;
template struct StateForceIn<3>;
template void add_state_loads<2>(const SystemIn<2>&, const StateIn<2>&, VectorXd&);
template void add_state_loads<3>(const SystemIn<3>&, const StateIn<3>&, VectorXd&);

}  // namespace flexarm::assembly
