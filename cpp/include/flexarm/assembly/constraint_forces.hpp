/// @file
/// Forces of the constraints, Φ_qᵀ λ: a term of equation (1) of equations.hpp, linear in the multipliers.
#pragma once

#include "flexarm/assembly/equations.hpp"

namespace flexarm::assembly {

/// Adds the rows of the nodes.
template <int D>
void add_constraint_forces_on_nodes(const SystemIn<D>& system, const StateIn<D>& state,
                                    const VectorXd& multipliers, VectorXd& r) {
  constexpr int n = geometry::freedoms<D>;
  static const geometry::FrameIn<D> base;
  int row = 0;
  for (const joints::JointConstraintIn<D>& joint : system.constraints()) {
    const int a = joint.node_a(), b = joint.node_b(), q = joint.coordinate(), m = joint.rows();
    geometry::Twist<D> lambda = geometry::Twist<D>::Zero();
    lambda.head(m) = multipliers.segment(row, m);
    const auto f =
        joint.forces(a < 0 ? base : state.frames[a], state.frames[b], q < 0 ? 0.0 : state.s[q], lambda);
    r.template segment<n>(n * b) += f.b;
    if (a >= 0) r.template segment<n>(n * a) += f.a;
    row += m;
  }
  const LoopClosuresIn<D>& closures = system.closures();
  if (!closures.empty()) closures.add_forces(state.frames, multipliers.tail(closures.rows()), r);
}

/// Adds the rows of the scalar coordinates; `r` has nothing else.
template <int D>
void add_constraint_forces_on_scalars(const SystemIn<D>& system, const StateIn<D>& state,
                                      const VectorXd& multipliers, Eigen::Ref<VectorXd> r) {
  int row = 0;
  for (const joints::JointConstraintIn<D>& joint : system.constraints()) {
    const int q = joint.coordinate();
    if (q >= 0) r[q] -= joint.twist().dot(multipliers.template segment<geometry::freedoms<D>>(row));
    row += joint.rows();
  }
  for (const joints::GearConstraint& gear : system.gears()) {
    r[gear.input] += gear.transmission(state.s[gear.input]).first * multipliers[row];
    r[gear.output] -= multipliers[row];
    ++row;
  }
}

}  // namespace flexarm::assembly
