#include "flexarm/assembly/equations.hpp"

#include "flexarm/assembly/constraint_forces.hpp"
#include "flexarm/assembly/tangent_terms.hpp"
#include "flexarm/errors.hpp"

namespace flexarm::assembly {

using namespace geometry;

namespace {

/// Internal and inertia forces of a beam.
template <int D>
[[gnu::always_inline]] inline void add_beam(const elements::BeamElementIn<D>& beam, const StateIn<D>& state,
                                            VectorXd& r) {
  constexpr int n = freedoms<D>;
  const int n1 = n * beam.node1(), n2 = n * beam.node2();
  elements::TwoTwists<D> v, v_dot;
  v.template head<n>() = state.v.template segment<n>(n1);
  v.template tail<n>() = state.v.template segment<n>(n2);
  v_dot.template head<n>() = state.v_dot.template segment<n>(n1);
  v_dot.template tail<n>() = state.v_dot.template segment<n>(n2);
  const auto f = beam.internal_forces(state.frames[beam.node1()], state.frames[beam.node2()],
                                      v.template head<n>(), v.template tail<n>(), state.elapsed());
  const elements::TwoTwists<D> inertia = beam.inertia_forces(v, v_dot);
  r.template segment<n>(n1) += f.f1 + inertia.template head<n>();
  r.template segment<n>(n2) += f.f2 + inertia.template tail<n>();
}

/// An element takes some hundred operations, so it pays to compile all of them into the loop.
template <int D>
[[gnu::flatten]] void add_beams(const SystemIn<D>& system, const StateIn<D>& state, VectorXd& r) {
  for (const auto& beam : system.beams()) add_beam<D>(beam, state, r);
}

/// The same, two beams at a time.
template <int D>
[[gnu::flatten]] void add_pairs_of_beams(const SystemIn<D>& system, const StateIn<D>& state, VectorXd& r) {
  for (const auto& pair : system.beam_pairs()) {
    pair.add_forces(state.frames.data(), state.v.data(), state.v_dot.data(), r.data());
  }
  for (const std::size_t k : system.single_beams()) add_beam<D>(system.beams()[k], state, r);
}

/// Forces of the joints, and how far they are apart.
template <int D>
[[gnu::flatten]] void add_joints(const SystemIn<D>& system, const StateIn<D>& state,
                                 const std::vector<bool>& left_out, VectorXd& r, VectorXd& phi) {
  constexpr int n = freedoms<D>;
  static const FrameIn<D> base;
  int row = 0;
  for (std::size_t k = 0; k < system.constraints().size(); ++k) {
    const auto& joint = system.constraints()[k];
    const int a = joint.node_a(), b = joint.node_b(), q = joint.coordinate(), m = joint.rows();
    if (!left_out.empty() && left_out[k]) {
      phi.segment(row, m).setZero();
      row += m;
      continue;
    }
    Twist<D> lambda = Twist<D>::Zero();
    lambda.head(m) = state.multipliers.segment(row, m);
    const auto now =
        joint.respond(a < 0 ? base : state.frames[a], state.frames[b], q < 0 ? 0.0 : state.s[q], lambda);
    r.template segment<n>(n * b) += now.forces.b;
    if (a >= 0) r.template segment<n>(n * a) += now.forces.a;
    phi.segment(row, m) = now.violation.head(m);
    row += m;
  }
}

}  // namespace

template <int D>
Twist<D> wrench(const PointLoadIn<D>& load, const AttachmentIn<D>& at, const FrameIn<D>& H) {
  const Rotation<D> to_node = load.follows ? at.offset.R : Rotation<D>(H.R.transpose());
  const Point<D> force = to_node * load.force;
  Turn<D> moment = load.moment;
  if constexpr (D == 3) moment = to_node * load.moment;
  Twist<D> f;
  f << force, moment + moment_of<D>(at.offset.x, force);
  return f;
}

template <int D>
const AttachmentIn<D>& SystemIn<D>::loaded_point(int point) const {
  if (point < 0 || point >= static_cast<int>(points_.size()) || points_[point].element >= 0) {
    throw InvalidParameter("a point load needs a point of the arm that is declared as loaded, got number " +
                           std::to_string(point));
  }
  return points_[point];
}

template <int D>
int SystemIn<D>::first_row(int constraint) const {
  int row = 0;
  for (int k = 0; k < constraint; ++k) row += constraints_[k].rows();
  return row;
}

template <int D>
typename SystemIn<D>::Part::Configuration SystemIn<D>::configuration(const Part& part,
                                                                     const StateD& state) const {
  const auto first = state.frames.begin() + part.node(0);
  return {{first, first + part.n_interfaces()}, state.s.segment(part.mode(0), part.n_modes())};
}

template <int D>
VectorXd SystemIn<D>::velocities(const Part& part, const VectorXd& v) const {
  VectorXd own(part.size());
  own << v.segment(n * part.node(0), n * part.n_interfaces()),
      v.segment(scalar_offset() + part.mode(0), part.n_modes());
  return own;
}

template <int D>
typename SystemIn<D>::Part::Motion SystemIn<D>::motion(const Part& part, const StateD& state) const {
  using View = Eigen::Map<const VectorXd>;
  const int first = n * part.node(0), size = n * part.n_interfaces(), modes = part.n_modes();
  const int first_mode = scalar_offset() + part.mode(0);
  return {&state.frames[part.node(0)],
          View(state.s.data() + part.mode(0), modes),
          View(state.v.data() + first, size),
          View(state.v.data() + first_mode, modes),
          View(state.v_dot.data() + first, size),
          View(state.v_dot.data() + first_mode, modes)};
}

template <int D>
int SystemIn<D>::row(const Part& part, int k) const {
  const int modes_from = n * part.n_interfaces();
  return k < modes_from ? n * part.node(0) + k : scalar_offset() + part.mode(k - modes_from);
}

template <int D>
void SystemIn<D>::remember(StateD& state) const {
  for (std::size_t k = 0; k < laws_.size(); ++k) {
    state.laws[k].x = deflection(laws_[k], state.s);
    state.laws[k].flank = joints::Flank::free;
  }
}

template <int D>
void SystemIn<D>::pair_beams() {
  for (std::size_t k = 0; k < beams_.size(); ++k) {
    if (k + 1 < beams_.size() && elements::BeamPairIn<D>::suits(beams_[k], beams_[k + 1])) {
      beam_pairs_.emplace_back(beams_[k], beams_[k + 1]);
      ++k;
    } else {
      single_beams_.push_back(k);
    }
  }
}

/// All of (1) that masses, loads and super-elements contribute.
template <int D>
void SystemIn<D>::add_masses(const StateD& state, const LoadsD& loads, VectorXd& r) const {
  for (const auto& body : bodies_) {
    const int k = n * body.node();
    r.template segment<n>(k) +=
        body.inertia_forces(state.v.template segment<n>(k), state.v_dot.template segment<n>(k));
  }
  for (int k = 0; k < n_nodes_; ++k)
    r.template segment<n>(n * k) -= weights_[k].force(state.frames[k].R, loads.gravity);
  for (const PointLoadIn<D>& load : loads.points) {
    const auto& at = loaded_point(load.point);
    r.template segment<n>(n * at.node) -= wrench<D>(load, at, state.frames[at.node]);
  }
  if (has_state_loads()) [[unlikely]]
    add_state_loads(*this, state, r);
  for (const Part& part : superelements_) {
    part.add_forces(motion(part, state), loads.gravity, r.segment(n * part.node(0), n * part.n_interfaces()),
                    r.segment(scalar_offset() + part.mode(0), part.n_modes()));
  }
}

template <int D>
void SystemIn<D>::residual(const StateD& state, const LoadsD& loads, bool friction, VectorXd& r) const {
  r.setZero();
  scalar_residual(state, friction, r.tail(n_scalars()));
  if (loads.torques.size() > 0) r.tail(n_scalars()) -= loads.torques;
  add_beams(*this, state, r);
  add_masses(state, loads, r);
  add_constraint_forces_on_nodes(*this, state, state.multipliers, r);
}

template <int D>
void SystemIn<D>::evaluate(const StateD& state, const LoadsD& loads, VectorXd& r, VectorXd& phi,
                           const std::vector<bool>& left_out) const {
  r.setZero();
  scalar_residual(state, true, r.tail(n_scalars()));
  if (loads.torques.size() > 0) r.tail(n_scalars()) -= loads.torques;
  add_masses(state, loads, r);
  add_joints(*this, state, left_out, r, phi);
  add_pairs_of_beams(*this, state, r);  // last: single numbers just written are slow to read as vectors
  int row = n_constraints_ - closures_.rows() - static_cast<int>(gears_.size());
  for (const joints::GearConstraint& gear : gears_)
    phi[row++] = gear.transmission(state.s[gear.input]).psi - state.s[gear.output];
  if (!closures_.empty())
    phi.tail(closures_.rows()) = closures_.add_forces(state.frames, of_closures(state), r);
}

template <int D>
void SystemIn<D>::scalar_residual(const StateD& state, bool friction, Eigen::Ref<VectorXd> r) const {
  for (int k = 0; k < n_scalars(); ++k) r[k] = scalar_inertia_[k] * state.v_dot[scalar_offset() + k];
  for (std::size_t k = 0; k < laws_.size(); ++k) {
    const PlacedLaw& law = laws_[k];
    if (!friction && !joints::acts_at_rest(law.law)) continue;
    const double force = respond(k, state).force;
    r[law.plus] += force;
    if (law.minus >= 0) r[law.minus] -= force;
  }
  add_constraint_forces_on_scalars(*this, state, state.multipliers, r);
}

template <int D>
void SystemIn<D>::violation(const StateD& state, VectorXd& phi) const {
  int row = 0;
  for (const Joint& joint : constraints_) {
    const int q = joint.coordinate();
    phi.segment(row, joint.rows()) =
        joint.violation(frame(state, joint.node_a()), frame(state, joint.node_b()), q < 0 ? 0.0 : state.s[q])
            .head(joint.rows());
    row += joint.rows();
  }
  for (const joints::GearConstraint& gear : gears_)
    phi[row++] = gear.transmission(state.s[gear.input]).psi - state.s[gear.output];
  if (!closures_.empty()) phi.tail(closures_.rows()) = closures_.violation(state.frames);
}

template <int D>
void SystemIn<D>::constraint_acceleration(const StateD& state, VectorXd& c) const {
  const auto rates = [&](const Joint& joint, const VectorXd& v) {
    const auto of = [&](int node) {
      return node < 0 ? TwistD(TwistD::Zero()) : TwistD(v.template segment<n>(n * node));
    };
    const int q = joint.coordinate();
    return
        typename Joint::Rates{of(joint.node_a()), of(joint.node_b()), q < 0 ? 0.0 : v[scalar_offset() + q]};
  };
  int row = 0;
  for (const Joint& joint : constraints_) {
    const int q = joint.coordinate();
    c.segment(row, joint.rows()) =
        joint
            .acceleration(frame(state, joint.node_a()), frame(state, joint.node_b()),
                          q < 0 ? 0.0 : state.s[q], rates(joint, state.v), rates(joint, state.v_dot))
            .head(joint.rows());
    row += joint.rows();
  }
  for (const joints::GearConstraint& gear : gears_) {
    const int in = scalar_offset() + gear.input, out = scalar_offset() + gear.output;
    const auto psi = gear.transmission(state.s[gear.input]);
    c[row++] = psi.first * state.v_dot[in] + psi.second * state.v[in] * state.v[in] - state.v_dot[out];
  }
  if (!closures_.empty())
    c.tail(closures_.rows()) = closures_.acceleration(state.frames, state.v, state.v_dot);
}

template <int D>
joints::LawArgument SystemIn<D>::argument(const PlacedLaw& law, const StateD& state) const {
  if (law.of < 0) return {0, 0, state.t};
  return {state.s[law.of], state.v[scalar_offset() + law.of], state.t};
}

template <int D>
joints::LawResponse SystemIn<D>::respond(std::size_t k, const StateD& state,
                                         const joints::JointLaw& law) const {
  const PlacedLaw& at = laws_[k];
  return joints::respond(law, deflection(at, state.s), deflection(at, state.v.tail(n_scalars())),
                         state.laws[k], argument(at, state));
}

template <int D>
VectorXd SystemIn<D>::law_tangents(const StateD& state, const TangentFactors& c, bool friction) const {
  VectorXd kappa = no_law_tangents();
  const auto n_laws = static_cast<Eigen::Index>(laws_.size());
  for (Eigen::Index k = 0; k < n_laws; ++k) {
    if (!friction && !joints::acts_at_rest(laws_[k].law)) continue;
    const joints::LawResponse response = respond(k, state);
    kappa[k] = c.stiffness * response.stiffness + c.damping * response.damping;
    if (c.hold_tables && laws_[k].moves_hinge()) continue;
    kappa[n_laws + k] = c.stiffness * response.force_by_y + c.damping * response.force_by_y_rate;
  }
  return kappa;
}

template <int D>
Eigen::SparseMatrix<double> SystemIn<D>::tangent(const StateD& state, const LoadsD& loads,
                                                 const TangentFactors& c, bool constraints) const {
  const int size = constraints ? n_unknowns() : n_free();
  std::vector<Eigen::Triplet<double>> entries;
  emit_tangent(state, loads, c, law_tangents(state, c, false), [&](int row, int column, double value) {
    if (row < size && column < size) entries.emplace_back(row, column, value);
  });
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

template <int D>
Eigen::SparseMatrix<double> SystemIn<D>::constraint_jacobian(const StateD& state) const {
  std::vector<Eigen::Triplet<double>> entries;
  emit_tangent(state, LoadsD{}, {0, 0, 0}, no_law_tangents(), [&](int row, int column, double value) {
    if (row >= n_free()) entries.emplace_back(row - n_free(), column, value);
  });
  Eigen::SparseMatrix<double> J(n_constraints_, n_free());
  J.setFromTriplets(entries.begin(), entries.end());
  return J;
}

template <int D>
typename SystemIn<D>::FrameD SystemIn<D>::point_frame(const StateD& state, int point) const {
  const auto& at = points_[point];
  if (at.element < 0) return state.frames[at.node] * at.offset;
  const Beam& beam = beams_[at.element];
  return beam.interpolate(state.frames[beam.node1()], state.frames[beam.node2()], at.xi) * at.offset;
}

template <int D>
typename SystemIn<D>::TwistD SystemIn<D>::point_velocity(const StateD& state, int point) const {
  const auto& at = points_[point];
  TwistD v;
  if (at.element < 0) {
    v = state.v.template segment<n>(n * at.node);
  } else {
    const Beam& beam = beams_[at.element];
    v = beam.interpolate_velocity(state.frames[beam.node1()], state.frames[beam.node2()],
                                  state.v.template segment<n>(n * beam.node1()),
                                  state.v.template segment<n>(n * beam.node2()), at.xi);
  }
  return adjoint_product<D>(at.offset.inverse(), v);
}

template <int D>
const joints::Transmission* SystemIn<D>::transmission(int joint) const {
  const JointCoordinates& at = joint_coordinates_[joint];
  if (at.psi == at.phi) return nullptr;
  for (const joints::GearConstraint& gear : gears_) {
    if (gear.input == at.phi && gear.output == at.psi) return &gear.transmission;
  }
  return nullptr;
}

template Twist<2> wrench<2>(const PointLoadIn<2>&, const AttachmentIn<2>&, const FrameIn<2>&);
template Twist<3> wrench<3>(const PointLoadIn<3>&, const AttachmentIn<3>&, const FrameIn<3>&);
template class SystemIn<2>;
template class SystemIn<3>;

}  // namespace flexarm::assembly
