/// @file
/// What one part of an arm puts on the next: section forces of beams, joint torques, motor torques, base
/// reactions.
///
/// A section force is what the part further from the link's origin puts on the part nearer to it, (N, V_y,
/// V_z) and (T, M_y, M_z) in the section's axes; N > 0 is tension. At the ends of a link it includes the
/// inertia and weight of the end elements, so reactions balance weight and inertia to rounding.
#pragma once

#include "flexarm/assembly/equations.hpp"
#include "flexarm/simulation/in_space.hpp"

namespace flexarm::simulation {

using assembly::LoadsIn;
using assembly::StateIn;
using assembly::SystemIn;
using geometry::Vector6d;

/// Section forces at the two ends of a link; zero for rigid links.
struct SectionForces {
  Vector6d start = Vector6d::Zero(), end = Vector6d::Zero();
};
template <int D>
SectionForces section_forces(const SystemIn<D>& system, const StateIn<D>& state, const LoadsIn<D>& loads,
                             int link, const InSpace<D>& space = {});

/// Torque on the child about the joint's axis, friction of the bearing already lost [N m, N].
template <int D>
double joint_torque(const SystemIn<D>& system, const StateIn<D>& state, int joint);

/// Torque of the motor, output-referred: rotor inertia and motor friction included. One a joint, zero without
/// a drive.
template <int D>
Eigen::VectorXd motor_torques(const SystemIn<D>& system, const StateIn<D>& state, bool friction);

/// Force and moment that a closure puts on its link b at the place `at`, all in base axes.
struct ClosureForce {
  Vector6d wrench;
  geometry::Vector3d at;
};
ClosureForce closure_force(const assembly::SystemIn<3>& system, const assembly::StateIn<3>& state,
                           std::size_t k);

/// Force and moment about the origin that the arm puts on the base, in base axes.
template <int D>
Vector6d base_wrench(const SystemIn<D>& system, const StateIn<D>& state, const InSpace<D>& space = {});

}  // namespace flexarm::simulation
