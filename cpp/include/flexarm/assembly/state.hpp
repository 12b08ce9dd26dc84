/// @file
/// The state of an arm at one instant: a value, copied and restored freely.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "flexarm/geometry/se3.hpp"
#include "flexarm/joints/joint_law.hpp"

namespace flexarm::assembly {

using Eigen::VectorXd;

/// Velocities and accelerations hold the freedoms of every node (six, three in a plane), in the node's axes,
/// then one entry for each scalar coordinate.
template <int D>
struct StateIn {
  double t = 0;                              ///< time [s]
  double start = 0;                          ///< when the run started [s]
  std::vector<geometry::FrameIn<D>> frames;  ///< nodes in the base frame
  VectorXd s;                                ///< scalar coordinates: angles φ, θ of the joints
  VectorXd v;                                ///< velocities
  VectorXd v_dot;                            ///< accelerations
  VectorXd a;                                ///< algorithmic accelerations of the time stepping
  VectorXd multipliers;                      ///< λ, joint wrenches
  std::vector<joints::LawMemory> laws;       ///< internal states of the joint laws

  double elapsed() const { return t - start; }  ///< since the start of the run [s]
};

using State = StateIn<3>;

}  // namespace flexarm::assembly
