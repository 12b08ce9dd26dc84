#include "flexarm/simulation/reactions.hpp"

namespace flexarm::simulation {

using namespace geometry;

namespace {

/// Forces that act on the two ends of an element from outside, in the nodes' axes.
template <int D>
elements::TwoTwists<D> end_forces(const SystemIn<D>& system, std::size_t k, const StateIn<D>& state,
                                  const LoadsIn<D>& loads) {
  constexpr int n = freedoms<D>;
  const auto& beam = system.beams()[k];
  const int n1 = n * beam.node1(), n2 = n * beam.node2();
  const FrameIn<D>&H1 = state.frames[beam.node1()], &H2 = state.frames[beam.node2()];
  elements::TwoTwists<D> v, v_dot;
  v << state.v.template segment<n>(n1), state.v.template segment<n>(n2);
  v_dot << state.v_dot.template segment<n>(n1), state.v_dot.template segment<n>(n2);
  const auto internal =
      beam.internal_forces(H1, H2, v.template head<n>(), v.template tail<n>(), state.elapsed());
  elements::TwoTwists<D> f = beam.inertia_forces(v, v_dot);
  const Point<D> arm = Point<D>::UnitX() * beam.end_moment();
  f.template head<n>() +=
      internal.f1 - elements::WeightIn<D>{beam.end_mass(), arm}.force(H1.R, loads.gravity);
  f.template tail<n>() +=
      internal.f2 - elements::WeightIn<D>{beam.end_mass(), -arm}.force(H2.R, loads.gravity);
  for (const auto& load : system.rest_strains()) {
    if (load.beam == k) f += load.forces(beam, state);
  }
  return f;
}

}  // namespace

template <int D>
SectionForces section_forces(const SystemIn<D>& system, const StateIn<D>& state, const LoadsIn<D>& loads,
                             int link, const InSpace<D>& space) {
  constexpr int n = freedoms<D>;
  const assembly::LinkMesh& mesh = system.meshes()[link];
  if (!mesh.is_beam()) return {};
  const auto first = static_cast<std::size_t>(mesh.first_element);
  const std::size_t last = first + static_cast<std::size_t>(mesh.n_nodes()) - 2;
  const auto& beams = system.beams();
  return {
      -space.wrench_at_node(beams[first].node1(), end_forces(system, first, state, loads).template head<n>()),
      space.wrench_at_node(beams[last].node2(), end_forces(system, last, state, loads).template tail<n>())};
}

template <int D>
double joint_torque(const SystemIn<D>& system, const StateIn<D>& state, int joint) {
  int row = 0;
  for (int k = 0; k < joint; ++k) row += system.constraints()[k].rows();
  const auto& constraint = system.constraints()[joint];
  if (constraint.coordinate() < 0) return 0.0;
  return -constraint.twist().dot(state.multipliers.template segment<freedoms<D>>(row));
}

template <int D>
Eigen::VectorXd motor_torques(const SystemIn<D>& system, const StateIn<D>& state, bool friction) {
  Eigen::VectorXd rows(system.n_scalars());
  system.scalar_residual(state, friction, rows);
  Eigen::VectorXd torque = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(system.joints().size()));
  for (std::size_t k = 0; k < system.joints().size(); ++k) {
    const int phi = system.joints()[k].phi;
    if (phi >= 0) torque[k] = rows[phi];
  }
  return torque;
}

namespace {

/// Force of a closure on the base and its moment about the origin, base axes; zero if it does not meet the
/// base.
template <int D>
Twist<D> closure_on_base(const SystemIn<D>& system, const StateIn<D>& state, std::size_t k) {
  const int base = system.pedestal().node;
  const auto& closures = system.closures();
  const auto& closure = closures[k];
  if (closure.node_a() != base && closure.node_b() != base) return Twist<D>::Zero();
  Twist<D> f = closures.wrench_on_b(k, state.frames, system.of_closures(state));
  f.template tail<turns<D>>() += moment_of<D>(closures.place_on_b(k, state.frames), f.template head<D>());
  return closure.node_a() == base ? Twist<D>(-f) : f;
}

}  // namespace

template <int D>
Vector6d base_wrench(const SystemIn<D>& system, const StateIn<D>& state, const InSpace<D>& space) {
  const int base = system.pedestal().node;  // a pedestal turns about the base's origin: moments stay
  const FrameIn<D> H = base < 0 ? FrameIn<D>{} : state.frames[base];
  Vector6d wrench = Vector6d::Zero();
  int row = 0;
  for (std::size_t k = 0; k < system.constraints().size(); ++k) {
    const auto& joint = system.constraints()[k];
    if (joint.node_a() == base) {
      Twist<D> lambda = Twist<D>::Zero();
      lambda.head(joint.rows()) = state.multipliers.segment(row, joint.rows());
      const int q = joint.coordinate();
      const Twist<D> f = joint.forces(H, state.frames[joint.node_b()], q < 0 ? 0.0 : state.s[q], lambda).a;
      wrench -= space.wrench_on_base(k, adjoint<D>(FrameIn<D>::rotation(H.R)) * f);
    }
    row += joint.rows();
  }
  for (std::size_t k = 0; k < system.closures().size(); ++k)
    wrench += space.wrench_on_base(system.constraints().size() + k, closure_on_base(system, state, k));
  return wrench;
}

ClosureForce closure_force(const assembly::SystemIn<3>& system, const assembly::StateIn<3>& state,
                           std::size_t k) {
  const auto& closures = system.closures();
  return {closures.wrench_on_b(k, state.frames, system.of_closures(state)),
          closures.place_on_b(k, state.frames)};
}

#define FLEXARM_INSTANTIATE(D)                                                                            \
  template SectionForces section_forces<D>(const SystemIn<D>&, const StateIn<D>&, const LoadsIn<D>&, int, \
                                           const InSpace<D>&);                                            \
  template double joint_torque<D>(const SystemIn<D>&, const StateIn<D>&, int);                            \
  template Eigen::VectorXd motor_torques<D>(const SystemIn<D>&, const StateIn<D>&, bool);                 \
  template Vector6d base_wrench<D>(const SystemIn<D>&, const StateIn<D>&, const InSpace<D>&);
FLEXARM_INSTANTIATE(2)
FLEXARM_INSTANTIATE(3)

}  // namespace flexarm::simulation
