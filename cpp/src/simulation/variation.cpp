#include "flexarm/simulation/variation.hpp"

#include "flexarm/errors.hpp"

namespace flexarm::simulation {

template <int D>
void VariationIn<D>::check(const assembly::SystemIn<D>& system) const {
  for (const auto* varied : {plus, minus}) {
    const bool same =
        varied->n_nodes() == system.n_nodes() && varied->n_scalars() == system.n_scalars() &&
        varied->n_free() == system.n_free() && varied->n_constraints() == system.n_constraints() &&
        varied->beams().size() == system.beams().size() &&
        varied->bodies().size() == system.bodies().size() &&
        varied->superelements().size() == system.superelements().size() &&
        varied->laws().size() == system.laws().size() && varied->points().size() == system.points().size() &&
        varied->rest_strains().size() == system.rest_strains().size() &&
        varied->state_forces().size() == system.state_forces().size();
    if (!same) {
      throw InvalidParameter(
          "a derivative needs a model whose structure does not change with the parameter; this one gains or "
          "loses nodes, coordinates or joint laws");
    }
  }
  if (!(spread() > 0)) throw InvalidParameter("the two values of a varied parameter must differ");
}

template <int D>
StateDerivative::StateDerivative(const assembly::SystemIn<D>& system, Eigen::Index n_parameters)
    : position(Slopes::Zero(system.n_velocities(), n_parameters)),
      velocity(position),
      v_dot(position),
      a(position),
      multipliers(Slopes::Zero(system.n_constraints(), n_parameters)),
      law_x(Slopes::Zero(static_cast<Eigen::Index>(system.laws().size()), n_parameters)),
      law_z(law_x) {}

template <int D>
assembly::StateIn<D> moved(const assembly::SystemIn<D>& system, const assembly::StateIn<D>& state,
                           const StateDerivative& derivative, Eigen::Index k, double amount) {
  constexpr int n = geometry::freedoms<D>;
  assembly::StateIn<D> there = state;
  for (int i = 0; i < system.n_nodes(); ++i) {
    const geometry::Twist<D> h = amount * derivative.position.col(k).template segment<n>(n * i);
    there.frames[i] = state.frames[i] * geometry::exponential<D>(h);
  }
  there.s += amount * derivative.position.col(k).tail(system.n_scalars());
  there.v += amount * derivative.velocity.col(k);
  there.v_dot += amount * derivative.v_dot.col(k);
  there.a += amount * derivative.a.col(k);
  there.multipliers += amount * derivative.multipliers.col(k);
  for (std::size_t law = 0; law < state.laws.size(); ++law) {
    there.laws[law].x += amount * derivative.law_x(static_cast<Eigen::Index>(law), k);
    there.laws[law].z += amount * derivative.law_z(static_cast<Eigen::Index>(law), k);
  }
  return there;
}

template struct VariationIn<2>;
template struct VariationIn<3>;
template StateDerivative::StateDerivative(const assembly::SystemIn<2>&, Eigen::Index);
template StateDerivative::StateDerivative(const assembly::SystemIn<3>&, Eigen::Index);
template assembly::StateIn<2> moved<2>(const assembly::SystemIn<2>&, const assembly::StateIn<2>&,
                                       const StateDerivative&, Eigen::Index, double);
template assembly::StateIn<3> moved<3>(const assembly::SystemIn<3>&, const assembly::StateIn<3>&,
                                       const StateDerivative&, Eigen::Index, double);

}  // namespace flexarm::simulation
