/// @file
/// Arms that the tests share, and ways to put them into states.
#pragma once

#include <numbers>

#include "flexarm/assembly/system.hpp"
#include "flexarm/integrators/increment.hpp"
#include "numerics.hpp"

// Designated initialisers name what matters to a test and leave the rest at its default on purpose.
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"

namespace flexarm::tests {

using assembly::DriveKind;
using assembly::Loads;
using assembly::State;
using assembly::System;
using geometry::Frame;
using geometry::Matrix3d;
using geometry::Vector3d;
using geometry::Vector6d;
using joints::DriveTrain;
using joints::JointType;
using joints::ReducerSpring;

constexpr double half_pi = std::numbers::pi / 2;
constexpr double standard_gravity = 9.81;

inline model::Material steel() { return {210e9, 80.77e9, 7850}; }

/// The tube of the paper: I = 2.37e-7 m⁴ and the area that belongs to it.
inline model::Section paper_tube() {
  constexpr double A = 5.82e-4, I = 2.37e-7;
  return {A, I, I, 2 * I, 0.53 * A, 0.53 * A};
}

/// A drive train of one spring and damper.
inline DriveTrain compliant(double stiffness, double damping = 0) {
  DriveTrain train;
  train.stages = {{ReducerSpring{stiffness, damping}}};
  return train;
}

struct PaperArm {
  int elements = 4;
  model::BeamTheory theory = model::BeamTheory::euler_bernoulli;
  double hub_stiffness = 0;  ///< 0: rigid hub
  double damping_ratio = 0;
};

/// 3 m tube along x, 14.1 kg at its tip, one hinge about y: at π/2 the arm hangs. Point 0 is the tip.
model::Arm paper_arm(const PaperArm& p = {});

/// A rigid bar of mass m, its centre at distance c along −z from a hinge about y; J about the centre.
model::Arm pendulum(double m, double c, double J);

/// Flexible enough that a few newtons bend it visibly.
model::BeamLink thin_beam(const std::string& name, const Vector3d& end, int elements);

/// Two beams in the vertical plane with compliant drives.
model::Arm two_link_arm();

/// Hinge, slide and hinge about three axes that share no plane; beam, rigid body, beam; frames turned between
/// them; payload with offset and inertia.
model::Arm spatial_arm();

/// A boom on a hinge about −y, held by a cylinder whose rod is hinged to it; a beam and rigid parts, a flat
/// loop.
model::Arm crane_arm();

/// The same with a rigid boom: three conditions of its closure repeat others.
model::Arm rigid_crane_arm();

/// Moves a state onto its constraints: the shortest step at a time.
void satisfy_constraints(const System& system, State& state);

/// Nodes pushed by up to `size`, everything else random too; constraints hold.
State random_state(const System& system, unsigned seed, double size = 0.1);

/// Free accelerations and multipliers that balance the state, so that time stepping starts smoothly.
/// [M Φ_qᵀ; Φ_q 0] (v', λ) = −(r at v' = λ = 0, Φ_q' v)
void balance(const System& system, const Loads& loads, State& state);

}  // namespace flexarm::tests
