#include "flexarm/simulation/energy.hpp"

namespace flexarm::simulation {

using namespace geometry;

Energies energies(const System& system, const State& state, const Loads& loads) {
  Energies E;
  for (const auto& beam : system.beams()) {
    const int n1 = 6 * beam.node1(), n2 = 6 * beam.node2();
    elements::Vector12d v;
    v << state.v.segment<6>(n1), state.v.segment<6>(n2);
    E.kinetic += 0.5 * v.dot(beam.mass() * v);
    const Vector6d e =
        beam.deformation(state.frames[beam.node1()], state.frames[beam.node2()], state.elapsed());
    E.elastic += 0.5 * e.dot(beam.stiffness().cwiseProduct(e));
  }
  for (const auto& part : system.superelements()) {
    const Eigen::VectorXd V = system.velocities(part, state.v);
    E.kinetic += 0.5 * V.dot(part.mass() * V);
    const auto forces = part.internal_forces(system.configuration(part, state), V, loads.gravity);
    E.elastic += forces.elastic;
    E.gravity += forces.gravity;
  }
  for (const auto& body : system.bodies()) {
    const Vector6d v = state.v.segment<6>(6 * body.node());
    E.kinetic += 0.5 * v.dot(body.mass() * v);
  }
  for (int k = 0; k < system.n_scalars(); ++k) {
    const double rate = state.v[system.scalar_offset() + k];
    E.kinetic += 0.5 * system.scalar_inertia()[k] * rate * rate;
  }
  for (std::size_t k = 0; k < system.laws().size(); ++k) {
    const auto& law = system.laws()[k];
    E.elastic += joints::respond(law.law, system.deflection(law, state.s), 0.0, state.laws[k]).energy;
  }
  for (int n = 0; n < system.n_nodes(); ++n)
    E.gravity += system.weights()[n].potential(state.frames[n], loads.gravity);
  return E;
}

namespace {

elements::BeamElement::EndForces end_forces(const elements::BeamElement& beam, const State& state) {
  return beam.internal_forces(state.frames[beam.node1()], state.frames[beam.node2()],
                              state.v.segment<6>(6 * beam.node1()), state.v.segment<6>(6 * beam.node2()),
                              state.elapsed());
}

}  // namespace

double bow_power(const System& system, const State& state) {
  double power = 0;
  for (const auto& beam : system.beams()) {
    if (beam.grows()) power += end_forces(beam, state).bow_power;
  }
  return power;
}

double link_dissipation(const System& system, const State& state) {
  double power = 0;
  for (const auto& beam : system.beams()) {
    if (beam.damping_time() > 0) power += end_forces(beam, state).dissipation;
  }
  for (const auto& part : system.superelements()) {
    power += part.internal_forces(system.configuration(part, state), system.velocities(part, state.v),
                                  Vector3d::Zero())
                 .dissipation;
  }
  return power;
}

Eigen::VectorXd law_losses(const System& system, const State& state) {
  Eigen::VectorXd loss(system.laws().size());
  for (std::size_t k = 0; k < system.laws().size(); ++k) {
    const auto& law = system.laws()[k];
    const double rate = system.deflection(law, state.v.tail(system.n_scalars()));
    loss[k] = joints::respond(law.law, system.deflection(law, state.s), rate, state.laws[k]).loss;
  }
  return loss;
}

double load_power(const System& system, const State& state, const Loads& loads) {
  double power = 0;
  for (const auto& load : loads.points) {
    const Matrix3d& R = system.point_frame(state, load.point).R;
    const Vector6d v = system.point_velocity(state, load.point);
    const Vector3d force = load.follows ? load.force : Vector3d(R.transpose() * load.force);
    const Vector3d moment = load.follows ? load.moment : Vector3d(R.transpose() * load.moment);
    power += force.dot(v.head<3>()) + moment.dot(v.tail<3>());
  }
  return power;
}

}  // namespace flexarm::simulation
