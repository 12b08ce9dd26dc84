/// @file
/// Writes states of a run into columns, and sums losses and work from instant to instant.
///
///     loss = ∫ P dt + Σ ∫ Q dx − ΔE,   work = Σ ∫ T dφ + ∫ F · v dt        by the trapezoidal rule      (1)
///
/// P: of the beams' damping [W], Q: dissipating force of a joint law over its deflection x, T: torque of a
/// motor over its angle φ, F: point loads. Laws with a second argument pass the energy E that they store on
/// to no coordinate of their own: all of their force counts as Q.
#pragma once

#include "flexarm/simulation/consistent_forces.hpp"
#include "flexarm/simulation/in_space.hpp"
#include "flexarm/simulation/transient.hpp"

namespace flexarm::simulation {

using assembly::LoadsIn;
using assembly::StateIn;
using assembly::SystemIn;

template <int D>
class RecorderIn {
 public:
  /// Makes room for n instants in `out`.
  RecorderIn(const SystemIn<D>& system, const TransientOptions& options, Eigen::Index n, Transient& out,
             const InSpace<D>& space = {});

  /// Writes instant k, in rising order; forces are those of consistent_forces.hpp.
  void record(Eigen::Index k, const StateIn<D>& state, const LoadsIn<D>& loads);

  /// The same with accelerations and forces as they are in the state.
  void write(Eigen::Index k, const StateIn<D>& state, const LoadsIn<D>& loads);

 private:
  struct Instant {
    double dissipation = 0, power = 0, in_passage = 0, t = 0;
    Eigen::VectorXd loss, drives, s;  // drives: rows of the scalar coordinates, what motors give
  };

  void points(Eigen::Index k, const StateIn<D>& state);
  void joints(Eigen::Index k, const StateIn<D>& state);
  void forces(Eigen::Index k, const StateIn<D>& state, const LoadsIn<D>& loads);
  void energy(Eigen::Index k, const StateIn<D>& state, const LoadsIn<D>& loads);

  const SystemIn<D>& system_;
  const InSpace<D> space_;
  const TransientOptions options_;
  Transient& out_;
  ConsistentForcesIn<D> forces_;
  Instant last_, now_;
};

using Recorder = RecorderIn<3>;

}  // namespace flexarm::simulation
