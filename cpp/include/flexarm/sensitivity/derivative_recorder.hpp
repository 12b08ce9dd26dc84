/// @file
/// Writes derivatives of a run's recorded columns, instant by instant.
///
/// Points: point_slopes.hpp; joints: joint_slopes.hpp. Section forces and the base's wrench are recorded
/// twice, in the state moved along its derivative, by both models of a variation (variation.hpp).
#pragma once

#include <vector>

#include "flexarm/sensitivity/joint_slopes.hpp"
#include "flexarm/sensitivity/point_slopes.hpp"
#include "flexarm/simulation/consistent_forces.hpp"

namespace flexarm::sensitivity {

using assembly::LoadsIn;
using assembly::StateIn;
using assembly::SystemIn;
using simulation::ConsistentForceSlopesIn;
using simulation::InSpace;
using simulation::StateDerivative;
using simulation::Transient;
using simulation::TransientOptions;
using simulation::VariationIn;

template <int D>
class DerivativeRecorderIn {
 public:
  /// Makes room for n instants in `out`: each row of a Recorder's columns becomes one row a parameter, those
  /// of one row behind one another.
  DerivativeRecorderIn(const SystemIn<D>& system, const InSpace<D>& space,
                       std::vector<VariedInSpace<D>> varied, const TransientOptions& options, Eigen::Index n,
                       Transient& out);
  DerivativeRecorderIn(const DerivativeRecorderIn&) = delete;  // its parts refer to `varied`
  DerivativeRecorderIn& operator=(const DerivativeRecorderIn&) = delete;

  /// Writes instant k.
  void record(Eigen::Index k, const StateIn<D>& state, const StateDerivative& derivative,
              const LoadsIn<D>& loads);

 private:
  void forces(Eigen::Index k, const StateIn<D>& state, const StateDerivative& derivative,
              const LoadsIn<D>& loads);

  const SystemIn<D>& system_;
  const std::vector<VariedInSpace<D>> varied_;
  const TransientOptions options_;
  Transient& out_;
  PointSlopesIn<D> points_;
  JointSlopesIn<D> joints_;
  ConsistentForceSlopesIn<D> forces_;
};

/// The variations alone.
template <int D>
std::vector<VariationIn<D>> variations_of(const std::vector<VariedInSpace<D>>& varied) {
  std::vector<VariationIn<D>> variations;
  for (const auto& each : varied) variations.push_back(each.variation);
  return variations;
}

}  // namespace flexarm::sensitivity
