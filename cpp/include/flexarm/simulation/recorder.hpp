/// @file
/// Writes states of a run into columns, and sums losses and work from instant to instant.
///
///     loss = ∫ P dt + Σ ∫ Q dx,   work = Σ ∫ T dφ + ∫ (F · v + B) dt  by the trapezoidal rule      (1)
///
/// P: of the beams' damping [W], Q: dissipating force of a joint law over its deflection x, T: torque of a
/// motor over its angle φ, or of what shakes the base over its angle, F: point loads, B: of growing bows [W].
#pragma once

#include "flexarm/simulation/transient.hpp"

namespace flexarm::simulation {

class Recorder {
 public:
  /// Makes room for n instants in `out`.
  Recorder(const System& system, const TransientOptions& options, Eigen::Index n, Transient& out);

  /// Writes instant k, in rising order.
  void record(Eigen::Index k, const State& state, const Loads& loads);

 private:
  struct Instant {
    double dissipation, power;
    Eigen::VectorXd loss, motor, s;
    double t;
  };

  void points(Eigen::Index k, const State& state);
  void joints(Eigen::Index k, const State& state);
  void forces(Eigen::Index k, const State& state, const Loads& loads);
  void energy(Eigen::Index k, const State& state, const Loads& loads);

  const System& system_;
  const TransientOptions options_;
  Transient& out_;
  Instant last_{};
};

}  // namespace flexarm::simulation
