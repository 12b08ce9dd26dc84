/// @file
/// Gears and transmissions of arms side by side: (1) of joints/transmission.hpp without windup. Included once
/// for each kind of processor.
#pragma once

#include "flexarm/lanes/row_code.hpp"

namespace flexarm::lanes {

/// Rows of gears among those of all constraints; scalar coordinates begin at `offset` of the velocities.
template <int N, class Processor>
class GearCode : RowCode<N, Processor> {
  using Rows = RowCode<N, Processor>;
  using Rows::add, Rows::at, Rows::put;
  using typename Rows::Real;

 public:
  /// Adds their forces on the scalar coordinates.
  static void add_forces(const Arms& arms, const Motion& motion, const double* multipliers, double* r) {
    for (int k = 0; k < arms.n_gears; ++k) {
      const auto [input, output, row, waves] = arms.gears[k];
      const Real force = at(multipliers, row);
      add(r, input, psi(arms, k, motion).first * force);
      add(r, output, -force);
    }
  }

  /// Φ.
  static void find_violation(const Arms& arms, const Motion& motion, double* phi) {
    for (int k = 0; k < arms.n_gears; ++k) {
      const GearPlace& place = arms.gears[k];
      put(phi, place.row, psi(arms, k, motion).psi - at(motion.s, place.output));
    }
  }

  /// Φ''.
  static void find_acceleration(const Arms& arms, const Motion& motion, int offset, double* c) {
    for (int k = 0; k < arms.n_gears; ++k) {
      const auto [input, output, row, waves] = arms.gears[k];
      const Psi gear = psi(arms, k, motion);
      const Real v = at(motion.v, offset + input), turned = at(motion.v_dot, offset + input);
      put(c, row, gear.first * turned + gear.second * v * v - at(motion.v_dot, offset + output));
    }
  }

 private:
  /// ψ, ψ' and ψ''.
  struct Psi {
    Real psi, first, second;
  };
  static Psi psi(const Arms& arms, int k, const Motion& motion) {
    const double* own = arms.gear_numbers + 4 * N * k;
    const Real phi = at(motion.s, arms.gears[k].input), per_scale = at(own, 0);
    if (!arms.gears[k].waves) return {phi * per_scale, per_scale, 0.0};
    const Real A = at(own, 1), m = at(own, 2);
    const auto [sine, cosine] = geometry::sine_cosine(Real(m * phi + at(own, 3)));
    return {phi * per_scale + A * sine, per_scale + m * (A * cosine), -m * m * (A * sine)};
  }
};

}  // namespace flexarm::lanes
