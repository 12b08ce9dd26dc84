/// @file
/// What parameters of a beam do to its forces in its two nodes, for several of them at once.
///
/// Columns of parameters are filled up to a multiple of four, with zeros, so that vectors of the processor
/// take them without a rest (simd/columns.hpp). In a state with strain e, its rate e' and velocities v, v'
/// of the ends,
///
///     ∂σ/∂p = ∂K/∂p e + ∂(η K)/∂p e' + (at rest)                     (1)  stress
///     ∂(f₁, f₂)/∂p = [−T_l⁻ᵀ; T_r⁻ᵀ] ∂σ/∂p                           (2)  of it, in the nodes
///     ∂(f₁, f₂)/∂p = ∂M/∂p v' − ad(v)ᵀ ∂M/∂p v                       (3)  of inertia
#pragma once

#include <vector>

#include "flexarm/elements/uncoupled.hpp"
#include "flexarm/geometry/plane.hpp"
#include "flexarm/geometry/se3.hpp"
#include "flexarm/simulation/variation.hpp"

namespace flexarm::sensitivity {

using simulation::Slopes;

/// So many columns for n parameters.
inline Eigen::Index filled_up(std::size_t n) { return static_cast<Eigen::Index>((n + 3) / 4 * 4); }

/// Rows of (1).
struct StressSlopes {
  Slopes by_strain, by_rate, at_rest;
};

/// Forces := (2); to_ends: [−T_l⁻ᵀ; T_r⁻ᵀ].
template <int D>
void stress_forces(const StressSlopes& slopes, const geometry::Twist<D>& e, const geometry::Twist<D>& e_dot,
                   const Eigen::Matrix<double, 2 * geometry::freedoms<D>, geometry::freedoms<D>>& to_ends,
                   Slopes& forces);

/// ∂M/∂p: one row for each entry of M that depends on a parameter.
struct MassSlopes {
  struct Entry {
    int row, column;
  };
  std::vector<Entry> entries;  ///< row after row
  Slopes mass;
};

/// Forces := (3).
template <int D>
void inertia_forces(const MassSlopes& slopes, const elements::TwoTwists<D>& v,
                    const elements::TwoTwists<D>& v_dot, Slopes& forces);

}  // namespace flexarm::sensitivity
