/// @file
/// The tangent of the equations of motion, term by term: what each element, weight, law and constraint of a
/// System adds to mass, damping and stiffness, and at which row and column.
///
/// They are told in an order that never changes, so that who listens finds the place of each once. A listener
/// has
///
///     add(row, column, mass, damping, stiffness)
///     stiffen(row, column, stiffness)             where there is nothing else
///     constrain(row, column, value)               an entry of Φ_q, or of its transpose
///     law(k, row, column, sign)                   the k-th of law_tangents(), which the listener knows
///
/// Matrices of an element that belong together are made together.
#pragma once

#include "flexarm/assembly/equations.hpp"

namespace flexarm::assembly {

namespace detail {

/// c_M M + c_C C + c_K K, and s Φ_q, one number after the other.
template <class Add>
struct SumOfTerms {
  const TangentFactors& c;
  const VectorXd& law_tangents;
  Add& tell;

  void add(int row, int column, double mass, double damping, double stiffness) const {
    tell(row, column, c.mass * mass + c.stiffness * stiffness + c.damping * damping);
  }
  void stiffen(int row, int column, double stiffness) const { tell(row, column, c.stiffness * stiffness); }
  void constrain(int row, int column, double value) const { tell(row, column, c.constraint * value); }
  void law(std::size_t k, int row, int column, double sign) const {
    tell(row, column, sign * law_tangents[static_cast<Eigen::Index>(k)]);
  }
};

}  // namespace detail

template <int D>
template <class Add>
void SystemIn<D>::emit_tangent(const StateD& state, const LoadsD& loads, const TangentFactors& c,
                               const VectorXd& law_tangents, Add&& add) const {
  const detail::SumOfTerms<Add> sum{c, law_tangents, add};
  emit_terms(state, loads, {c.damping != 0, c.stiffness != 0, !c.hold_tables}, sum);
}

template <int D>
template <class Terms>
void SystemIn<D>::emit_terms(const StateD& state, const LoadsD& loads, WantedTerms wanted,
                             Terms&& terms) const {
  emit_elements(state, loads, wanted, terms);
  emit_weights(state, loads, wanted, terms);
  if (has_state_loads()) emit_state_loads(state, wanted, terms);
  for (int s = 0; s < n_free_scalars_; ++s) {
    terms.add(scalar_offset() + s, scalar_offset() + s, scalar_inertia_[s], 0, 0);
  }
  for (std::size_t k = 0; k < laws_.size(); ++k) {
    const int plus = laws_[k].plus, minus = laws_[k].minus, at = scalar_offset();
    const bool free_plus = is_free(plus), free_minus = minus >= 0 && is_free(minus);
    if (free_plus) terms.law(k, at + plus, at + plus, 1);
    if (free_minus) terms.law(k, at + minus, at + minus, 1);
    if (free_plus && free_minus) {
      terms.law(k, at + plus, at + minus, -1);
      terms.law(k, at + minus, at + plus, -1);
    }
    const int of = laws_[k].of;
    if (of < 0 || !is_free(of)) continue;
    if (free_plus) terms.law(laws_.size() + k, at + plus, at + of, 1);
    if (free_minus) terms.law(laws_.size() + k, at + minus, at + of, -1);
  }
  emit_joints(state, wanted, terms);
  emit_closures(state, wanted, terms);
}

template <int D>
template <class Terms>
void SystemIn<D>::emit_elements(const StateD& state, const LoadsD& loads, WantedTerms wanted,
                                Terms& terms) const {
  typename Beam::TangentMatrices of;
  of.stiffness.setZero();
  of.damping.setZero();
  for (const Beam& beam : beams_) {
    const int at[] = {n * beam.node1(), n * beam.node2()};
    elements::TwoTwists<D> v;
    v << state.v.template segment<n>(at[0]), state.v.template segment<n>(at[1]);
    if (wanted.damping || wanted.stiffness) {
      beam.find_tangents(state.frames[beam.node1()], state.frames[beam.node2()], v, state.elapsed(),
                         wanted.damping, wanted.stiffness, of);
    }
    for (int a = 0; a < 2; ++a)
      for (int b = 0; b < 2; ++b)
        for (int j = n * b; j < n * b + n; ++j)
          for (int i = n * a; i < n * a + n; ++i)
            terms.add(at[a] + i - n * a, at[b] + j - n * b, beam.mass()(i, j), of.damping(i, j),
                      of.stiffness(i, j));
  }
  TwistMatrixD gyroscopic = TwistMatrixD::Zero();
  for (const auto& body : bodies_) {
    const int at = n * body.node();
    if (wanted.damping) gyroscopic = body.gyroscopic_matrix(state.v.template segment<n>(at));
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) terms.add(at + i, at + j, body.mass()(i, j), gyroscopic(i, j), 0);
  }
  for (const Part& part : superelements_) {
    const auto at = configuration(part, state);
    const VectorXd V = velocities(part, state.v);
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(part.size(), part.size()), K = C;
    if (wanted.stiffness) K = part.stiffness_matrix(at, V, loads.gravity);
    if (wanted.damping) C = part.damping_matrix(at) + part.gyroscopic_matrix(V);
    for (int j = 0; j < part.size(); ++j)
      for (int i = 0; i < part.size(); ++i)
        terms.add(row(part, i), row(part, j), part.mass()(i, j), C(i, j), K(i, j));
  }
}

template <int D>
template <class Terms>
void SystemIn<D>::emit_weights(const StateD& state, const LoadsD& loads, WantedTerms wanted,
                               Terms& terms) const {
  const auto block = [&](int at, const TwistMatrixD& K) {
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) terms.stiffen(at + i, at + j, K(i, j));
  };
  TwistMatrixD K = TwistMatrixD::Zero();
  for (int k = 0; k < n_nodes_; ++k) {
    if (wanted.stiffness) K = weights_[k].stiffness(state.frames[k].R, loads.gravity);
    block(n * k, K);
  }
  for (const PointLoadIn<D>& load : loads.points) {
    const auto& at = loaded_point(load.point);
    if (load.follows) continue;
    const geometry::Rotation<D>& R = state.frames[at.node].R;
    K = elements::WeightIn<D>{1, at.offset.x}.stiffness(R, load.force);
    if constexpr (D == 3) K.template bottomRightCorner<3, 3>() -= geometry::skew(R.transpose() * load.moment);
    block(n * at.node, K);
  }
}

template <int D>
template <class Terms>
void SystemIn<D>::emit_state_loads(const StateD& state, WantedTerms wanted, Terms& terms) const {
  const auto column = [&](const PlacedTable& table, int first_row, const auto& by_y) {
    if (!is_free(table.scalar)) return;
    for (int i = 0; i < by_y.size(); ++i) {
      const double by_rate = table.of_rate ? by_y[i] : 0.0;
      terms.add(first_row + i, scalar_offset() + table.scalar, 0, by_rate, by_y[i] - by_rate);
    }
  };
  for (const RestStrainIn<D>& strain : rest_strains_) {
    const Beam& beam = beams_[strain.beam];
    const int at[] = {n * beam.node1(), n * beam.node2()};
    StateTangentIn<D, 2 * n> of;
    if (wanted.damping || wanted.stiffness) of = strain.tangent(beam, state, wanted.tables);
    for (int a = 0; a < 2; ++a) {
      for (int b = 0; b < 2; ++b)
        for (int j = 0; j < n; ++j)
          for (int i = 0; i < n; ++i) terms.stiffen(at[a] + i, at[b] + j, of.stiffness(n * a + i, n * b + j));
      column(strain.table, at[a], of.by_y.template segment<n>(n * a));
    }
  }
  for (const StateForceIn<D>& force : state_forces_) {
    StateTangentIn<D, n> of;
    if (wanted.damping || wanted.stiffness) of = force.tangent(state, wanted.tables);
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) terms.stiffen(n * force.node + i, n * force.node + j, of.stiffness(i, j));
    column(force.table, n * force.node, of.by_y);
  }
}

template <int D>
template <class Terms>
void SystemIn<D>::emit_joints(const StateD& state, WantedTerms wanted, Terms& terms) const {
  const auto stiffen = [&](int row, int column, const auto& K) {
    for (int j = 0; j < K.cols(); ++j)
      for (int i = 0; i < K.rows(); ++i) terms.stiffen(row + i, column + j, K(i, j));
  };
  int first_row = n_free();
  for (const Joint& joint : constraints_) {
    const int a = joint.node_a(), b = joint.node_b(), q = joint.coordinate(), m = joint.rows();
    const FrameD &H_a = frame(state, a), &H_b = frame(state, b);
    const double theta = q < 0 ? 0.0 : state.s[q];
    const auto J = joint.jacobian(H_a, H_b, theta);
    TwistD lambda = TwistD::Zero();
    if (wanted.stiffness) lambda.head(m) = state.multipliers.segment(first_row - n_free(), m);
    const auto K = joint.geometric_stiffness(H_a, H_b, theta, lambda);
    const auto both = [&](int column, const auto& B) {  // constraint rows and, transposed, multiplier columns
      for (int j = 0; j < B.cols(); ++j)
        for (int i = 0; i < m; ++i) terms.constrain(first_row + i, column + j, B(i, j));
      for (int i = 0; i < m; ++i)
        for (int j = 0; j < B.cols(); ++j) terms.constrain(column + j, first_row + i, B(i, j));
    };
    both(n * b, J.b);
    if (a >= 0) {
      both(n * a, J.a);
      if (joint.type() == joints::JointType::spherical) {
        stiffen(n * a, n * a, K.a_a);
        stiffen(n * a, n * b, K.a_b);
      }
    }
    if (q >= 0 && is_free(q)) {
      both(scalar_offset() + q, J.theta);
      if (a >= 0) stiffen(n * a, scalar_offset() + q, K.a_theta);
    }
    first_row += m;
  }
  for (const joints::GearConstraint& gear : gears_) {
    const auto both = [&](int coordinate, double value) {
      if (!is_free(coordinate)) return;
      terms.constrain(first_row, scalar_offset() + coordinate, value);
      terms.constrain(scalar_offset() + coordinate, first_row, value);
    };
    const auto psi = gear.transmission(state.s[gear.input]);
    both(gear.input, psi.first);
    both(gear.output, -1);
    const int at = scalar_offset() + gear.input;
    if (is_free(gear.input)) terms.stiffen(at, at, psi.second * state.multipliers[first_row - n_free()]);
    ++first_row;
  }
}

template <int D>
template <class Terms>
void SystemIn<D>::emit_closures(const StateD& state, WantedTerms wanted, Terms& terms) const {
  if (closures_.empty()) return;
  VectorXd mu = VectorXd::Zero(closures_.rows());
  if (wanted.stiffness) mu = of_closures(state);
  const int first_row = n_unknowns() - closures_.rows();
  closures_.emit(
      state.frames, mu,
      [&](int row, int column, double value) {
        terms.constrain(first_row + row, column, value);
        terms.constrain(column, first_row + row, value);
      },
      [&](int row, int column, double value) { terms.stiffen(row, column, value); });
}

}  // namespace flexarm::assembly
