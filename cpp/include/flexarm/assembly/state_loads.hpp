/// @file
/// Loads that tables of a joint's state give: a strain that a beam has without stress, and a force.
///
///     p = f(y, t),    y = s_k or s_k'                                                               (1)
///     f₁ = T_l⁻ᵀ K b p,  f₂ = −T_r⁻ᵀ K b p       forces (3) of elements/beam.hpp of a strain b p    (2)
///     f = −(γ, c × γ),   γ = Rᵀ F p              force F p, base axes, at c in a node's axes        (3)
///
/// Both are evaluated with the equations of motion, so that a step is implicit in them. Nothing acts back on
/// the joint: they give or take energy. The damper of a beam resists the whole rate of its strain. Units: of
/// K b and F newtons and metres per unit of p.
#pragma once

#include "flexarm/assembly/state.hpp"
#include "flexarm/elements/beam.hpp"
#include "flexarm/elements/weight.hpp"
#include "flexarm/joints/laws/changing_table.hpp"

namespace flexarm::assembly {

/// f of (1), and the scalar coordinate k.
struct PlacedTable {
  joints::ChangingTable table;
  int scalar = 0;
  bool of_rate = false;

  bool operator==(const PlacedTable&) const = default;

  /// p and its derivatives with respect to y.
  template <int D>
  joints::MonotoneCubic::Value at(const StateIn<D>& state) const {
    return table.at(state.t)(y(state));
  }
  /// p' [1/s].
  template <int D>
  double rate(const StateIn<D>& state) const {
    const double y_dot = (of_rate ? state.v_dot : state.v)[of_velocity(state)];
    return at(state).first * y_dot + table.at(state.t).rate(y(state));
  }

 private:
  template <int D>
  double y(const StateIn<D>& state) const {
    return of_rate ? state.v[of_velocity(state)] : state.s[scalar];
  }
  template <int D>
  Eigen::Index of_velocity(const StateIn<D>& state) const {
    return state.v.size() - state.s.size() + scalar;
  }
};

/// ∂f/∂(increments of the nodes) and ∂f/∂y.
template <int D, int N>
struct StateTangentIn {
  Eigen::Matrix<double, N, N> stiffness = Eigen::Matrix<double, N, N>::Zero();
  Eigen::Matrix<double, N, 1> by_y = Eigen::Matrix<double, N, 1>::Zero();
};

template <int D>
struct RestStrainIn {
  static constexpr int n = geometry::freedoms<D>;
  using Beam = elements::BeamElementIn<D>;
  using Ends = typename Beam::Ends;

  PlacedTable table;
  std::size_t beam;           ///< its number
  geometry::Twist<D> strain;  ///< b

  bool operator==(const RestStrainIn&) const = default;

  /// Equation (2).
  Ends forces(const Beam& beam, const StateIn<D>& state) const;
  /// @param moving whether p moves with y
  StateTangentIn<D, 2 * n> tangent(const Beam& beam, const StateIn<D>& state, bool moving) const;
};

template <int D>
struct StateForceIn {
  static constexpr int n = geometry::freedoms<D>;

  PlacedTable table;
  int node;
  geometry::Point<D> place, force;  ///< c and F

  bool operator==(const StateForceIn&) const = default;

  /// Equation (3).
  geometry::Twist<D> forces(const StateIn<D>& state) const;
  StateTangentIn<D, n> tangent(const StateIn<D>& state, bool moving) const;
};

template <int D>
class SystemIn;

/// Adds the forces of all state loads to r.
template <int D>
void add_state_loads(const SystemIn<D>& system, const StateIn<D>& state, VectorXd& r);

}  // namespace flexarm::assembly
