#include "flexarm/assembly/system.hpp"

#include "flexarm/errors.hpp"

namespace flexarm::assembly {
namespace {

using namespace geometry;

const Frame base_frame;

}  // namespace

const Attachment& System::loaded_point(int point) const {
  if (point < 0 || point >= static_cast<int>(points_.size()) || points_[point].element >= 0) {
    throw InvalidParameter("a point load needs a point of the arm that is declared as loaded, got number " +
                           std::to_string(point));
  }
  return points_[point];
}

const Frame& System::frame(const State& state, int node) const {
  return node < 0 ? base_frame : state.frames[node];
}

State System::rigid_state(const std::vector<double>& joint_values) const {
  if (joint_values.size() != arm_.joints.size()) {
    throw InvalidParameter("one value for each of the " + std::to_string(arm_.joints.size()) +
                           " joints is needed, got " + std::to_string(joint_values.size()));
  }
  State state;
  state.frames.resize(n_nodes_);
  state.s = VectorXd::Zero(n_scalars());
  state.v = state.v_dot = state.a = VectorXd::Zero(n_velocities());
  state.multipliers = VectorXd::Zero(n_constraints_);
  state.laws.resize(laws_.size());

  std::vector<double> theta = joint_values;
  for (std::size_t k = 0; k < theta.size(); ++k) {
    const JointCoordinates& at = joint_coordinates_[k];
    if (at.phi < 0) continue;
    state.s[at.phi] = joint_values[k];
    if (const joints::Transmission* psi = transmission(static_cast<int>(k))) {
      if (drives_[k] == DriveKind::link_angle) {
        state.s[at.phi] = psi->inverse(theta[k]);
      } else {
        theta[k] = (*psi)(joint_values[k]).psi;
      }
    }
    state.s[at.psi] = state.s[at.theta] = theta[k];
  }
  for (const PlacedLaw& law : laws_) {  // stages are listed from motor to link: no deflection in any
    if (law.minus >= 0) state.s[law.minus] = state.s[law.plus];
  }

  std::vector<bool> placed(arm_.links.size(), false);
  for (bool progress = true; progress;) {
    progress = false;
    for (std::size_t k = 0; k < arm_.joints.size(); ++k) {
      const model::Joint& joint = arm_.joints[k];
      const Place child = place(joint.child);
      if (placed[child.link]) continue;
      Frame A = joint.origin;  // a pedestal stands where the base does
      if (joint.parent != "base") {
        const Place parent = place(joint.parent, joint.at_end);
        if (!placed[parent.link]) continue;
        A = state.frames[node(parent)] * axes(parent) * joint.origin;
      }
      const Frame B = A * exp6(theta[k] * joints::motion_twist(joint.type, joint.axis));
      const LinkMesh& mesh = meshes_[child.link];
      const Frame link = B * mesh.place_in_link(child.node).inverse();
      for (int n = 0; n < mesh.n_nodes(); ++n) state.frames[mesh.first_node + n] = mesh.node_frame(link, n);
      placed[child.link] = progress = true;
    }
  }
  for (std::size_t k = 0; k < placed.size(); ++k) {
    if (!placed[k])
      throw InvalidParameter("link '" + model::name_of(arm_.links[k]) +
                             "' is not connected to the base by joints");
  }
  remember(state);
  return state;
}

const joints::Transmission* System::transmission(int joint) const {
  const JointCoordinates& at = joint_coordinates_[joint];
  if (at.psi == at.phi) return nullptr;
  for (const joints::GearConstraint& gear : gears_) {
    if (gear.input == at.phi && gear.output == at.psi) return &gear.transmission;
  }
  return nullptr;
}

elements::SuperElement::Configuration System::configuration(const elements::SuperElement& part,
                                                            const State& state) const {
  const auto first = state.frames.begin() + part.node(0);
  return {{first, first + part.n_interfaces()}, state.s.segment(part.mode(0), part.n_modes())};
}

VectorXd System::velocities(const elements::SuperElement& part, const VectorXd& v) const {
  VectorXd own(part.size());
  own << v.segment(6 * part.node(0), 6 * part.n_interfaces()),
      v.segment(scalar_offset() + part.mode(0), part.n_modes());
  return own;
}

int System::row(const elements::SuperElement& part, int k) const {
  const int modes_from = 6 * part.n_interfaces();
  return k < modes_from ? 6 * part.node(0) + k : scalar_offset() + part.mode(k - modes_from);
}

void System::remember(State& state) const {
  for (std::size_t k = 0; k < laws_.size(); ++k) {
    state.laws[k].x = deflection(laws_[k], state.s);
    state.laws[k].flank = joints::Flank::free;
  }
}

void System::residual(const State& state, const Loads& loads, bool friction, VectorXd& r) const {
  r.setZero();
  for (const elements::BeamElement& beam : beams_) {
    const int n1 = 6 * beam.node1(), n2 = 6 * beam.node2();
    elements::Vector12d v, v_dot;
    v << state.v.segment<6>(n1), state.v.segment<6>(n2);
    v_dot << state.v_dot.segment<6>(n1), state.v_dot.segment<6>(n2);
    const auto f = beam.internal_forces(state.frames[beam.node1()], state.frames[beam.node2()], v.head<6>(),
                                        v.tail<6>(), state.elapsed());
    const elements::Vector12d inertia = beam.inertia_forces(v, v_dot);
    r.segment<6>(n1) += f.f1 + inertia.head<6>();
    r.segment<6>(n2) += f.f2 + inertia.tail<6>();
  }
  for (const elements::RigidBody& body : bodies_) {
    const int n = 6 * body.node();
    r.segment<6>(n) += body.inertia_forces(state.v.segment<6>(n), state.v_dot.segment<6>(n));
  }
  for (int n = 0; n < n_nodes_; ++n)
    r.segment<6>(6 * n) -= weights_[n].force(state.frames[n].R, loads.gravity);
  for (const PointLoad& load : loads.points) {
    const Attachment& at = loaded_point(load.point);
    const Matrix3d to_node = load.follows ? at.offset.R : Matrix3d(state.frames[at.node].R.transpose());
    const Vector3d force = to_node * load.force;
    r.segment<3>(6 * at.node) -= force;
    r.segment<3>(6 * at.node + 3) -= to_node * load.moment + at.offset.x.cross(force);
  }

  int row = 0;
  for (const joints::JointConstraint& joint : constraints_) {
    const int a = joint.node_a(), b = joint.node_b(), q = joint.coordinate(), m = joint.rows();
    Vector6d lambda = Vector6d::Zero();
    lambda.head(m) = state.multipliers.segment(row, m);
    const auto f = joint.forces(frame(state, a), frame(state, b), q < 0 ? 0.0 : state.s[q], lambda);
    r.segment<6>(6 * b) += f.b;
    if (a >= 0) r.segment<6>(6 * a) += f.a;
    row += m;
  }
  scalar_residual(state, friction, r.tail(n_scalars()));
  if (loads.torques.size() > 0) r.tail(n_scalars()) -= loads.torques;

  for (const elements::SuperElement& part : superelements_) {
    const VectorXd V = velocities(part, state.v);
    const VectorXd f = part.internal_forces(configuration(part, state), V, loads.gravity).f +
                       part.inertia_forces(V, velocities(part, state.v_dot));
    r.segment(6 * part.node(0), 6 * part.n_interfaces()) += f.head(6 * part.n_interfaces());
    r.segment(scalar_offset() + part.mode(0), part.n_modes()) += f.tail(part.n_modes());
  }
}

void System::scalar_residual(const State& state, bool friction, Eigen::Ref<VectorXd> r) const {
  for (int k = 0; k < n_scalars(); ++k) r[k] = scalar_inertia_[k] * state.v_dot[scalar_offset() + k];
  for (std::size_t k = 0; k < laws_.size(); ++k) {
    const PlacedLaw& law = laws_[k];
    if (!friction && !joints::acts_at_rest(law.law)) continue;
    const double rate = deflection(law, state.v.tail(n_scalars()));
    const double force = joints::respond(law.law, deflection(law, state.s), rate, state.laws[k]).force;
    r[law.plus] += force;
    if (law.minus >= 0) r[law.minus] -= force;
  }
  int row = 0;
  for (const joints::JointConstraint& joint : constraints_) {
    const int q = joint.coordinate();
    if (q >= 0) r[q] -= joint.twist().dot(state.multipliers.segment<6>(row));
    row += joint.rows();
  }
  for (const joints::GearConstraint& gear : gears_) {
    r[gear.input] += gear.transmission(state.s[gear.input]).first * state.multipliers[row];
    r[gear.output] -= state.multipliers[row];
    ++row;
  }
}

void System::violation(const State& state, VectorXd& phi) const {
  int row = 0;
  for (const joints::JointConstraint& joint : constraints_) {
    const int q = joint.coordinate();
    phi.segment(row, joint.rows()) =
        joint.violation(frame(state, joint.node_a()), frame(state, joint.node_b()), q < 0 ? 0.0 : state.s[q])
            .head(joint.rows());
    row += joint.rows();
  }
  for (const joints::GearConstraint& gear : gears_)
    phi[row++] = gear.transmission(state.s[gear.input]).psi - state.s[gear.output];
}

VectorXd System::law_tangents(const State& state, const TangentFactors& c, bool friction) const {
  VectorXd kappa(laws_.size());
  for (std::size_t k = 0; k < laws_.size(); ++k) {
    const PlacedLaw& law = laws_[k];
    kappa[k] = 0;
    if (!friction && !joints::acts_at_rest(law.law)) continue;
    const auto response = joints::respond(law.law, deflection(law, state.s),
                                          deflection(law, state.v.tail(n_scalars())), state.laws[k]);
    kappa[k] = c.stiffness * response.stiffness + c.damping * response.damping;
  }
  return kappa;
}

Eigen::SparseMatrix<double> System::tangent(const State& state, const Loads& loads, const TangentFactors& c,
                                            bool constraints) const {
  const int n = constraints ? n_unknowns() : n_free();
  std::vector<Eigen::Triplet<double>> entries;
  emit_tangent(state, loads, c, law_tangents(state, c, false), [&](int row, int column, double value) {
    if (row < n && column < n) entries.emplace_back(row, column, value);
  });
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Eigen::SparseMatrix<double> System::constraint_jacobian(const State& state) const {
  std::vector<Eigen::Triplet<double>> entries;
  emit_tangent(state, Loads{}, {0, 0, 0}, VectorXd::Zero(laws_.size()),
               [&](int row, int column, double value) {
                 if (row >= n_free()) entries.emplace_back(row - n_free(), column, value);
               });
  Eigen::SparseMatrix<double> J(n_constraints_, n_free());
  J.setFromTriplets(entries.begin(), entries.end());
  return J;
}

Frame System::point_frame(const State& state, int point) const {
  const Attachment& at = points_[point];
  if (at.element < 0) return state.frames[at.node] * at.offset;
  const elements::BeamElement& beam = beams_[at.element];
  return beam.interpolate(state.frames[beam.node1()], state.frames[beam.node2()], at.xi) * at.offset;
}

Vector6d System::point_velocity(const State& state, int point) const {
  const Attachment& at = points_[point];
  Vector6d v;
  if (at.element < 0) {
    v = state.v.segment<6>(6 * at.node);
  } else {
    const elements::BeamElement& beam = beams_[at.element];
    v = beam.interpolate_velocity(state.frames[beam.node1()], state.frames[beam.node2()],
                                  state.v.segment<6>(6 * beam.node1()), state.v.segment<6>(6 * beam.node2()),
                                  at.xi);
  }
  return adjoint(at.offset.inverse()) * v;
}

}  // namespace flexarm::assembly
