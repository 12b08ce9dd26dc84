#include "flexarm/simulation/energy.hpp"

namespace flexarm::simulation {

using namespace geometry;

namespace {

/// Kinetic and elastic energy of the beams, and what damping and bows do.
template <int D>
[[gnu::flatten]] void add_beams(const SystemIn<D>& system, const StateIn<D>& state, Energies& E) {
  constexpr int n = freedoms<D>;
  for (const auto& beam : system.beams()) {
    const FrameIn<D>&H1 = state.frames[beam.node1()], &H2 = state.frames[beam.node2()];
    elements::TwoTwists<D> v;
    v << state.v.template segment<n>(n * beam.node1()), state.v.template segment<n>(n * beam.node2());
    E.kinetic += 0.5 * v.dot(beam.momentum(v));
    if (beam.damping_time() == 0 && !beam.grows()) {
      const Twist<D> e = beam.deformation(H1, H2);
      E.elastic += 0.5 * e.dot(beam.stiffness().cwiseProduct(e));
      continue;
    }
    const auto f = beam.internal_forces(H1, H2, v.template head<n>(), v.template tail<n>(), state.elapsed());
    E.elastic += f.energy;
    E.dissipation += f.dissipation;
    E.bow_power += f.bow_power;
  }
}

template <int D>
void add_parts(const SystemIn<D>& system, const StateIn<D>& state, const LoadsIn<D>& loads, Energies& E) {
  for (const auto& part : system.superelements()) {
    const auto now = part.energies(system.motion(part, state), loads.gravity);
    E.kinetic += now.kinetic;
    E.elastic += now.elastic;
    E.gravity += now.gravity;
    E.dissipation += now.dissipation;
  }
}

/// Curvatures and forces that tables of a joint's state give. A strain r = b p takes the elastic energy from
/// ½ eᵀ K e to ½ (e − r)ᵀ K (e − r).
template <int D>
void add_table_energies(const SystemIn<D>& system, const StateIn<D>& state, Energies& E) {
  constexpr int n = freedoms<D>;
  for (const auto& load : system.rest_strains()) {
    const auto& beam = system.beams()[load.beam];
    const FrameIn<D>&H1 = state.frames[beam.node1()], &H2 = state.frames[beam.node2()];
    const Twist<D> e = beam.deformation(H1, H2, state.elapsed()), r = load.table.at(state).y * load.strain;
    E.elastic += (0.5 * r - e).dot(beam.stiffness().cwiseProduct(r));
    E.table_power -= load.table.rate(state) * load.strain.dot(beam.stiffness().cwiseProduct(e - r));
    if (beam.grows()) E.bow_power += beam.bow_rate(state.elapsed()).dot(beam.stiffness().cwiseProduct(r));
  }
  for (const auto& load : system.state_forces())
    E.table_power -= load.forces(state).dot(state.v.template segment<n>(n * load.node));
}

}  // namespace

template <int D>
Energies energies(const SystemIn<D>& system, const StateIn<D>& state, const LoadsIn<D>& loads) {
  constexpr int n = freedoms<D>;
  Energies E;
  add_beams(system, state, E);
  add_parts(system, state, loads, E);
  if (system.has_state_loads()) [[unlikely]]
    add_table_energies(system, state, E);
  for (const auto& body : system.bodies()) {
    const Twist<D> v = state.v.template segment<n>(n * body.node());
    E.kinetic += 0.5 * v.dot(body.mass() * v);
  }
  for (int k = 0; k < system.n_scalars(); ++k) {
    const double rate = state.v[system.scalar_offset() + k];
    E.kinetic += 0.5 * system.scalar_inertia()[k] * rate * rate;
  }
  for (std::size_t k = 0; k < system.laws().size(); ++k) {
    const double stored = system.respond(k, state).energy;
    E.elastic += stored;
    if (system.laws()[k].of >= 0) E.in_passage += stored;
  }
  for (int k = 0; k < system.n_nodes(); ++k)
    E.gravity += system.weights()[k].potential(state.frames[k], loads.gravity);
  return E;
}

template <int D>
void law_losses(const SystemIn<D>& system, const StateIn<D>& state, Eigen::VectorXd& loss) {
  loss.resize(static_cast<Eigen::Index>(system.laws().size()));
  for (std::size_t k = 0; k < system.laws().size(); ++k)
    loss[static_cast<Eigen::Index>(k)] = system.respond(k, state).loss;
}

template <int D>
double load_power(const SystemIn<D>& system, const StateIn<D>& state, const LoadsIn<D>& loads) {
  double power = 0;
  for (const auto& load : loads.points) {
    const Rotation<D> R = system.point_frame(state, load.point).R;
    const Twist<D> v = system.point_velocity(state, load.point);
    const Point<D> force = load.follows ? load.force : Point<D>(R.transpose() * load.force);
    Turn<D> moment = load.moment;
    if constexpr (D == 3) {
      if (!load.follows) moment = R.transpose() * load.moment;
    }
    power += force.dot(v.template head<D>()) + moment.dot(v.template tail<turns<D>>());
  }
  return power;
}

#define FLEXARM_INSTANTIATE(D)                                                             \
  template Energies energies<D>(const SystemIn<D>&, const StateIn<D>&, const LoadsIn<D>&); \
  template void law_losses<D>(const SystemIn<D>&, const StateIn<D>&, Eigen::VectorXd&);    \
  template double load_power<D>(const SystemIn<D>&, const StateIn<D>&, const LoadsIn<D>&);
FLEXARM_INSTANTIATE(2)
FLEXARM_INSTANTIATE(3)

}  // namespace flexarm::simulation
