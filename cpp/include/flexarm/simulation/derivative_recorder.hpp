/// @file
/// Writes derivatives of a run's recorded columns, instant by instant.
///
/// Angles and points that sit on a node have theirs in closed form: with the point's place o and velocity u
/// in the node's axes,
///
///     x = x_n + R o,  ẋ = R u,  u = v_n + ω × o                                                     (1)
///     dx/dp = R (ξ_x + ξ_ω × o + do/dp),  dẋ/dp = R (ξ_ω × u + dv_n + dω × o + ω × do/dp)            (2)
///
/// Torques follow from scalar coordinates and multipliers alone. All other columns are recorded twice, in the
/// state moved along its derivative, by both models of a variation (variation.hpp).
#pragma once

#include <vector>

#include "flexarm/simulation/recorder.hpp"
#include "flexarm/simulation/variation.hpp"

namespace flexarm::simulation {

template <int D>
class DerivativeRecorderIn {
 public:
  /// A variation with the places of both its models in space.
  struct Varied {
    VariationIn<D> models;
    InSpace<D> plus, minus;
  };

  /// Makes room for n instants in `out`, one entry a parameter.
  DerivativeRecorderIn(const SystemIn<D>& system, const InSpace<D>& space, std::vector<Varied> varied,
                       const TransientOptions& options, Eigen::Index n, std::vector<Transient>& out);

  /// Writes instant k.
  void record(Eigen::Index k, const StateIn<D>& state, const StateDerivative& derivative,
              const LoadsIn<D>& loads);

 private:
  bool closed_forms_do() const;
  void points(Eigen::Index k, std::size_t p, const StateIn<D>& state, const StateDerivative& derivative);
  void joints(Eigen::Index k, std::size_t p, const StateIn<D>& state, const StateDerivative& derivative);
  void everything(Eigen::Index k, std::size_t p, const StateIn<D>& state, const StateDerivative& derivative,
                  const LoadsIn<D>& loads);

  const SystemIn<D>& system_;
  const InSpace<D> space_;
  const std::vector<Varied> varied_;
  const TransientOptions options_;  // without energies
  std::vector<Transient>& out_;
  bool closed_forms_;
  StateIn<D> beside_;  // the state with scalar coordinates and multipliers moved
};

}  // namespace flexarm::simulation
