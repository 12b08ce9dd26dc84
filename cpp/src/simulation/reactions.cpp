#include "flexarm/simulation/reactions.hpp"

namespace flexarm::simulation {

using namespace geometry;

namespace {

/// Forces that act on the two ends of an element from outside, in the nodes' axes.
elements::Vector12d end_forces(const elements::BeamElement& beam, const State& state, const Loads& loads) {
  const int n1 = 6 * beam.node1(), n2 = 6 * beam.node2();
  const Frame &H1 = state.frames[beam.node1()], &H2 = state.frames[beam.node2()];
  elements::Vector12d v, v_dot;
  v << state.v.segment<6>(n1), state.v.segment<6>(n2);
  v_dot << state.v_dot.segment<6>(n1), state.v_dot.segment<6>(n2);
  const auto internal = beam.internal_forces(H1, H2, v.head<6>(), v.tail<6>(), state.elapsed());
  elements::Vector12d f = beam.inertia_forces(v, v_dot);
  const Vector3d arm = Vector3d::UnitX() * beam.end_moment();
  f.head<6>() += internal.f1 - elements::Weight{beam.end_mass(), arm}.force(H1.R, loads.gravity);
  f.tail<6>() += internal.f2 - elements::Weight{beam.end_mass(), -arm}.force(H2.R, loads.gravity);
  return f;
}

}  // namespace

SectionForces section_forces(const System& system, const State& state, const Loads& loads, int link) {
  const assembly::LinkMesh& mesh = system.meshes()[link];
  if (!mesh.is_beam()) return {};
  const auto& first = system.beams()[mesh.first_element];
  const auto& last = system.beams()[mesh.first_element + mesh.n_nodes() - 2];
  return {-end_forces(first, state, loads).head<6>(), end_forces(last, state, loads).tail<6>()};
}

double joint_torque(const System& system, const State& state, int joint) {
  int row = 0;
  for (int k = 0; k < joint; ++k) row += system.constraints()[k].rows();
  const auto& constraint = system.constraints()[joint];
  return constraint.coordinate() < 0 ? 0.0 : -constraint.twist().dot(state.multipliers.segment<6>(row));
}

Eigen::VectorXd motor_torques(const System& system, const State& state, bool friction) {
  Eigen::VectorXd rows(system.n_scalars());
  system.scalar_residual(state, friction, rows);
  Eigen::VectorXd torque = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(system.joints().size()));
  for (std::size_t k = 0; k < system.joints().size(); ++k) {
    const int phi = system.joints()[k].phi;
    if (phi >= 0) torque[k] = rows[phi];
  }
  return torque;
}

Vector6d base_wrench(const System& system, const State& state) {
  const int base = system.pedestal().node;  // a pedestal turns about the base's origin: moments stay
  const Frame H = base < 0 ? Frame{} : state.frames[base];
  Vector6d wrench = Vector6d::Zero();
  int row = 0;
  for (const auto& joint : system.constraints()) {
    if (joint.node_a() == base) {
      Vector6d lambda = Vector6d::Zero();
      lambda.head(joint.rows()) = state.multipliers.segment(row, joint.rows());
      const int q = joint.coordinate();
      wrench -= joint.forces(H, state.frames[joint.node_b()], q < 0 ? 0.0 : state.s[q], lambda).a;
    }
    row += joint.rows();
  }
  wrench << H.R * wrench.head<3>(), H.R * wrench.tail<3>();
  return wrench;
}

}  // namespace flexarm::simulation
