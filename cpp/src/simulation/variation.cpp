#include "flexarm/simulation/variation.hpp"

#include "flexarm/errors.hpp"

namespace flexarm::simulation {

void Variation::check(const System& system) const {
  for (const System* varied : {plus, minus}) {
    const bool same =
        varied->n_nodes() == system.n_nodes() && varied->n_scalars() == system.n_scalars() &&
        varied->n_free() == system.n_free() && varied->n_constraints() == system.n_constraints() &&
        varied->laws().size() == system.laws().size() && varied->points().size() == system.points().size();
    if (!same) {
      throw InvalidParameter(
          "a derivative needs a model whose structure does not change with the parameter; this one gains or "
          "loses nodes, coordinates or joint laws");
    }
  }
  if (!(spread() > 0)) throw InvalidParameter("the two values of a varied parameter must differ");
}

StateDerivative::StateDerivative(const System& system, Eigen::Index n_parameters)
    : position(MatrixXd::Zero(system.n_velocities(), n_parameters)),
      velocity(position),
      v_dot(position),
      a(position),
      multipliers(MatrixXd::Zero(system.n_constraints(), n_parameters)),
      law_x(MatrixXd::Zero(static_cast<Eigen::Index>(system.laws().size()), n_parameters)),
      law_z(law_x) {}

State moved(const System& system, const State& state, const StateDerivative& derivative, Eigen::Index k,
            double amount) {
  State there = state;
  for (int n = 0; n < system.n_nodes(); ++n) {
    there.frames[n] = state.frames[n] * geometry::exp6(amount * derivative.position.col(k).segment<6>(6 * n));
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

}  // namespace flexarm::simulation
