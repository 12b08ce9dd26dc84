#include "flexarm/sensitivity/partial_residuals.hpp"

namespace flexarm::sensitivity {

using namespace geometry;
using namespace simulation;

template <int D>
void PartialResidualsIn<D>::prescribe(double t, StateDerivative& derivative) {
  const int n_driven = system_.n_velocities() - system_.n_free();
  for (const Eigen::Index k : driven_) {
    const VariationIn<D>& p = variations_[k];
    p.drive_plus(t, up_);
    p.drive_minus(t, down_);
    derivative.position.col(k).tail(n_driven) = (up_.s - down_.s).tail(n_driven) / p.spread();
    derivative.velocity.col(k).tail(n_driven) = (up_.v - down_.v).tail(n_driven) / p.spread();
    derivative.v_dot.col(k).tail(n_driven) = (up_.v_dot - down_.v_dot).tail(n_driven) / p.spread();
    torques_.col(k) = (up_.torques - down_.torques) / p.spread();
  }
}

template <int D>
void PartialResidualsIn<D>::evaluate(const StateD& state, const StateDerivative& derivative,
                                     const LoadsD& loads, const LawSlopesIn<D>& laws, Slopes& rhs) {
  rhs.setZero(system_.n_unknowns(), derivative.size());
  stresses(state, rhs);
  inertia(state, rhs);
  weights(state, loads, rhs);
  if (system_.has_state_loads()) state_loads(state, derivative, rhs);
  joints(state, rhs);
  closures(state, rhs);
  parts(state, loads, rhs);
  force_laws(derivative, laws, rhs);
  driven(state, derivative, laws, rhs);
}

/// The last two terms of (1), with e counted from the rest of the nominal beam: a rest that does not depend
/// on the parameter drops out exactly.
template <int D>
void PartialResidualsIn<D>::rest(Strained& group, double t) const {
  const Twist<D> nominal = system_.beams()[group.beam].rest(t);
  for (std::size_t j = 0; j < group.columns.size(); ++j) {
    const auto stress = [&](const Beam& beam) -> Twist<D> {
      return beam.stiffness().cwiseProduct(beam.rest(t) - nominal + beam.damping_time() * beam.bow_rate(t));
    };
    const auto [plus, minus] = group.models[j];
    group.slopes.at_rest.col(static_cast<Eigen::Index>(j)) =
        (stress(*minus) - stress(*plus)) / variations_[group.columns[j]].spread();
  }
}

/// Equation (1).
template <int D>
void PartialResidualsIn<D>::stresses(const StateD& state, Slopes& rhs) {
  for (Strained& group : strained_) {
    const Beam& beam = system_.beams()[group.beam];
    const int n1 = n * beam.node1(), n2 = n * beam.node2();
    const Twist<D> d = logarithm<D>(relative<D>(state.frames[beam.node1()], state.frames[beam.node2()]));
    const Twist<D> v1 = state.v.template segment<n>(n1), v2 = state.v.template segment<n>(n2);
    const Twist<D> e = d - beam.rest(state.elapsed());
    const Twist<D> e_dot = InverseTangentIn<D>(d).strain_rate(v1, v2);
    if (group.grows) rest(group, state.elapsed());
    Eigen::Matrix<double, 2 * n, n> to_ends;
    to_ends << -left_tangent_inverse<D>(d).transpose(), right_tangent_inverse<D>(d).transpose();
    stress_forces<D>(group.slopes, e, e_dot, to_ends, forces_);
    take(beam, group.columns, rhs);
  }
}

/// Takes forces in the nodes of a beam from the right side.
template <int D>
void PartialResidualsIn<D>::take(const Beam& beam, const Columns& columns, Slopes& rhs) const {
  const Eigen::Index n_parameters = rhs.cols(), m = forces_.cols();
  const double* force = forces_.data();
  for (const int node : {beam.node1(), beam.node2()}) {
    double* row = rhs.data() + n * node * n_parameters;
    for (int i = 0; i < n; ++i, force += m, row += n_parameters) {
      for (std::size_t j = 0; j < columns.size(); ++j) row[columns[j]] -= force[j];
    }
  }
}

/// Equation (2), and rotors.
template <int D>
void PartialResidualsIn<D>::inertia(const StateD& state, Slopes& rhs) {
  for (const Massive& group : massive_) {
    const Beam& beam = system_.beams()[group.beam];
    elements::TwoTwists<D> v, v_dot;
    v << state.v.template segment<n>(n * beam.node1()), state.v.template segment<n>(n * beam.node2());
    v_dot << state.v_dot.template segment<n>(n * beam.node1()),
        state.v_dot.template segment<n>(n * beam.node2());
    inertia_forces<D>(group.slopes, v, v_dot, forces_);
    take(beam, group.columns, rhs);
  }
  for (const auto& [k, column, body] : bodies_) {
    const int at = n * body.node();
    rhs.col(column).template segment<n>(at) -=
        body.inertia_forces(state.v.template segment<n>(at), state.v_dot.template segment<n>(at));
  }
  for (const auto& [k, column, slope] : rotors_) {
    const Eigen::Index row = system_.scalar_offset() + static_cast<Eigen::Index>(k);
    rhs(row, column) -= slope * state.v_dot[row];
  }
}

template <int D>
void PartialResidualsIn<D>::weights(const StateD& state, const LoadsD& loads, Slopes& rhs) const {
  for (const auto& [node, column, weight] : weights_) {
    rhs.col(column).template segment<n>(n * static_cast<Eigen::Index>(node)) +=
        weight.force(state.frames[node].R, loads.gravity);
  }
  for (const auto& load : loads.points) {
    for (std::size_t p = 0; p < variations_.size(); ++p) {
      const auto &up = variations_[p].plus->points()[load.point],
                 &down = variations_[p].minus->points()[load.point];
      const FrameIn<D>& H = state.frames[up.node];
      rhs.col(static_cast<Eigen::Index>(p)).template segment<n>(n * up.node) +=
          (assembly::wrench<D>(load, up, H) - assembly::wrench<D>(load, down, H)) / variations_[p].spread();
    }
  }
}

/// In both models, and by prescribed coordinates that move with a parameter.
template <int D>
void PartialResidualsIn<D>::state_loads(const StateD& state, const StateDerivative& derivative,
                                        Slopes& rhs) const {
  VectorXd r(system_.n_velocities());
  for (std::size_t p = 0; p < variations_.size(); ++p) {
    const VariationIn<D>& one = variations_[p];
    r.setZero();
    assembly::add_state_loads(*one.minus, state, r);
    r = -r;
    assembly::add_state_loads(*one.plus, state, r);
    rhs.col(static_cast<Eigen::Index>(p)).head(system_.n_free()) -= r.head(system_.n_free()) / one.spread();
  }
  const auto along = [&](const assembly::PlacedTable& table, int node, const auto& by_y) {
    if (system_.is_free(table.scalar)) return;
    const Slopes& rows = table.of_rate ? derivative.velocity : derivative.position;
    for (const Eigen::Index p : driven_)
      rhs.col(p).template segment<n>(n * node) -= by_y * rows(system_.scalar_offset() + table.scalar, p);
  };
  for (const auto& load : system_.rest_strains()) {
    const Beam& beam = system_.beams()[load.beam];
    const auto by_y = load.tangent(beam, state, true).by_y;
    along(load.table, beam.node1(), by_y.template head<n>());
    along(load.table, beam.node2(), by_y.template tail<n>());
  }
  for (const auto& load : system_.state_forces())
    along(load.table, load.node, load.tangent(state, true).by_y);
}

template <int D>
void PartialResidualsIn<D>::joints(const StateD& state, Slopes& rhs) const {
  static const FrameIn<D> ground;
  const auto frame = [&](int node) -> const FrameIn<D>& { return node < 0 ? ground : state.frames[node]; };
  const auto add = [&](const joints::JointConstraintIn<D>& joint, int row, Eigen::Index column, double sign) {
    const int a = joint.node_a(), b = joint.node_b(), q = joint.coordinate(), m = joint.rows();
    const double theta = q < 0 ? 0.0 : state.s[q];
    Twist<D> lambda = Twist<D>::Zero();
    lambda.head(m) = state.multipliers.segment(row, m);
    const auto f = joint.forces(frame(a), frame(b), theta, lambda);
    const Twist<D> violation = joint.violation(frame(a), frame(b), theta);
    rhs.col(column).template segment<n>(n * b) += sign * f.b;
    if (a >= 0) rhs.col(column).template segment<n>(n * a) += sign * f.a;
    if (q >= 0 && system_.is_free(q)) {
      rhs(system_.scalar_offset() + q, column) -= sign * joint.twist().dot(lambda);
    }
    rhs.col(column).segment(system_.n_free() + row, m) += sign * violation.head(m);
  };
  for (const auto& one : joints_) {
    const int row = system_.first_row(static_cast<int>(one.index));
    const double per_spread = 1 / variations_[one.column].spread();
    add(*one.plus, row, one.column, -per_spread);
    add(*one.minus, row, one.column, per_spread);
  }
  const auto n_joints = static_cast<int>(system_.constraints().size());
  for (const auto& one : gears_) {
    const int row = system_.first_row(n_joints) + static_cast<int>(one.index), input = one.plus->input;
    const double per_spread = 1 / variations_[one.column].spread();
    const auto up = one.plus->transmission(state.s[input]), down = one.minus->transmission(state.s[input]);
    rhs(system_.n_free() + row, one.column) -= per_spread * (up.psi - down.psi);
    if (!system_.is_free(input)) continue;
    rhs(system_.scalar_offset() + input, one.column) -=
        per_spread * (up.first - down.first) * state.multipliers[row];
  }
}

template <int D>
void PartialResidualsIn<D>::closures(const StateD& state, Slopes& rhs) const {
  for (const Eigen::Index k : looped_) {
    const VariationIn<D>& p = variations_[k];
    const auto add = [&](const SystemD& model, double sign) {
      VectorXd r = VectorXd::Zero(system_.n_velocities());
      const VectorXd phi = model.closures().add_forces(state.frames, system_.of_closures(state), r);
      rhs.col(k).head(system_.n_free()) += sign * r.head(system_.n_free());
      rhs.col(k).tail(phi.size()) += sign * phi;
    };
    add(*p.plus, -1 / p.spread());
    add(*p.minus, 1 / p.spread());
  }
}

template <int D>
void PartialResidualsIn<D>::parts(const StateD& state, const LoadsD& loads, Slopes& rhs) {
  for (const auto& one : parts_) {
    const VectorXd V = system_.velocities(*one.plus, state.v),
                   V_dot = system_.velocities(*one.plus, state.v_dot);
    const auto forces = [&](const elements::SuperElementIn<D>& part) -> VectorXd {
      return part.internal_forces(system_.configuration(part, state), V, loads.gravity).f +
             part.inertia_forces(V, V_dot);
    };
    const VectorXd f = (forces(*one.plus) - forces(*one.minus)) / variations_[one.column].spread();
    const int at_nodes = n * one.plus->n_interfaces(), n_modes = one.plus->n_modes();
    rhs.col(one.column).segment(n * one.plus->node(0), at_nodes) -= f.head(at_nodes);
    rhs.col(one.column).segment(system_.scalar_offset() + one.plus->mode(0), n_modes) -= f.tail(n_modes);
  }
}

template <int D>
void PartialResidualsIn<D>::force_laws(const StateDerivative& derivative, const LawSlopesIn<D>& laws,
                                       Slopes& rhs) const {
  for (std::size_t k = 0; k < system_.laws().size(); ++k) {
    const auto& law = system_.laws()[k];
    const auto force = laws.force_of_the_past(k, derivative);
    if (system_.is_free(law.plus)) rhs.row(system_.scalar_offset() + law.plus) -= force;
    if (law.minus >= 0 && system_.is_free(law.minus)) rhs.row(system_.scalar_offset() + law.minus) += force;
  }
}

/// What prescribed coordinates that move with a parameter, and motor torques, do to laws, joints and gears.
template <int D>
void PartialResidualsIn<D>::driven(const StateD& state, const StateDerivative& derivative,
                                   const LawSlopesIn<D>& laws, Slopes& rhs) const {
  const int offset = system_.scalar_offset();
  const auto told = [&](const Slopes& rows, int scalar, Eigen::Index p) {  // of a prescribed coordinate
    return scalar < 0 || system_.is_free(scalar) ? 0.0 : rows(offset + scalar, p);
  };
  for (const Eigen::Index p : driven_) {
    const auto add = [&](int scalar, double force) {
      if (system_.is_free(scalar)) rhs(offset + scalar, p) += force;
    };
    for (int s = 0; s < system_.n_scalars(); ++s) add(s, torques_(s, p));
    for (std::size_t k = 0; k < system_.laws().size(); ++k) {
      const auto& law = system_.laws()[k];
      const auto along = [&](const Slopes& rows) {
        return told(rows, law.plus, p) - told(rows, law.minus, p);
      };
      const joints::LawResponse& at = laws.response(k);
      const double force = at.stiffness * along(derivative.position) +
                           at.damping * along(derivative.velocity) +
                           at.force_by_y * told(derivative.position, law.of, p) +
                           at.force_by_y_rate * told(derivative.velocity, law.of, p);
      add(law.plus, -force);
      if (law.minus >= 0) add(law.minus, force);
    }
    int row = 0;
    for (const auto& joint : system_.constraints()) {
      const int a = joint.node_a(), b = joint.node_b(), q = joint.coordinate(), m = joint.rows();
      if (const double turned = told(derivative.position, q, p); turned != 0) {
        static const FrameIn<D> ground;
        const FrameIn<D>& H_a = a < 0 ? ground : state.frames[a];
        Twist<D> lambda = Twist<D>::Zero();
        lambda.head(m) = state.multipliers.segment(row, m);
        const auto& H_b = state.frames[b];
        rhs.col(p).segment(system_.n_free() + row, m) -=
            turned * joint.jacobian(H_a, H_b, state.s[q]).theta.head(m);
        const auto K = joint.geometric_stiffness(H_a, H_b, state.s[q], lambda);
        if (a >= 0) rhs.col(p).template segment<n>(n * a) -= turned * K.a_theta;
      }
      row += m;
    }
    for (const auto& gear : system_.gears()) {
      rhs(system_.n_free() + row, p) -=
          gear.transmission(state.s[gear.input]).first * told(derivative.position, gear.input, p) -
          told(derivative.position, gear.output, p);
      ++row;
    }
  }
}

template class PartialResidualsIn<2>;
template class PartialResidualsIn<3>;

}  // namespace flexarm::sensitivity
