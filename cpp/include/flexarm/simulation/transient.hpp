/// @file
/// A run in time: from an equilibrium at rest, along prescribed drives, recorded at equal steps.
#pragma once

#include <functional>
#include <vector>

#include "flexarm/assembly/planar_system.hpp"
#include "flexarm/integrators/hht.hpp"
#include "flexarm/simulation/piecewise_polynomial.hpp"
#include "flexarm/simulation/statics.hpp"

namespace flexarm::simulation {

/// Where a motion is computed. A motion in a plane takes three coordinates a node instead of six and is the
/// same: assembly/planar_system.hpp.
enum class Dimension {
  automatic,  ///< in the plane, if the arm moves in one
  plane,      ///< in the plane, or not at all
  space,
};

struct TransientOptions {
  double start = 0, end = 1;  ///< [s]
  double step = 2e-3;         ///< [s]; the last instant is the first at or after `end`
  double alpha = -0.05;
  double tolerance = 1e-10;  ///< of HhtOptions
  Dimension dimension = Dimension::automatic;
  bool record_points = true;      ///< positions and velocities of the points
  bool record_rotations = false;  ///< their orientations and angular rates
  bool record_joints = true;      ///< angles, rates, torques
  bool record_energies = false;
  bool record_forces = false;  ///< section forces and base wrench
  /// Torques, forces and work are those of consistent_forces.hpp, not of the time stepping.
  bool consistent_forces = true;

  bool has_consistent_forces() const {
    return consistent_forces && (record_joints || record_energies || record_forces);
  }
};

/// Recorded columns; one column an instant. Sizes: n instants, p points, j joints, l links.
struct Transient {
  using Matrix = Eigen::MatrixXd;
  Eigen::VectorXd time;                       ///< (n) [s]
  Matrix position, velocity;                  ///< (3 p, n), base axes [m], [m/s]
  Matrix orientation;                         ///< (4 p, n), unit quaternion x, y, z, w of the link's axes
  Matrix angular_rate;                        ///< (3 p, n), link axes [rad/s]
  Matrix joint_angle, joint_rate;             ///< (j, n), θ [rad], [rad/s]
  Matrix drive_angle, drive_rate;             ///< (j, n), φ
  Matrix joint_torque, motor_torque;          ///< (j, n) [N m], output side
  Eigen::VectorXd kinetic, elastic, gravity;  ///< (n) [J]
  Eigen::VectorXd damped, work;               ///< (n) since the start [J]
  Matrix section_forces;                      ///< (12 l, n): start then end
  Matrix base_wrench;                         ///< (6, n)
  integrators::HhtStatistics statistics;
  State final_state;
  int dimension = 3;       ///< 2 if it was computed in a plane
  double seconds = 0;      ///< of the stepping, wall clock
  bool cancelled = false;  ///< then only the instants reached are there

  void finish(Eigen::Index n);  ///< keeps the first n instants
};

/// Told now and then how much is done, 0 to 1; returns false to cancel.
using Progress = std::function<bool(double done)>;

/// It is called so often at most.
constexpr double seconds_between_calls = 0.02;

/// Observer of a run: told of every step that is taken, and of every instant recorded.
template <int D>
struct RunObserverIn {
  integrators::StepObserverIn<D> step;
  std::function<void(Eigen::Index k, const assembly::StateIn<D>& state, const assembly::LoadsIn<D>& loads)>
      record;
};

/// @param drives one a joint: angle of driven joints [rad], torque of motors [N m]; not read for free and
/// locked joints.
/// @throws NotConverged; InvalidParameter if a plane is asked for and something leaves it.
Transient simulate(const System& system, const Equilibrium& equilibrium,
                   const std::vector<PiecewisePolynomial>& drives, const TransientOptions& options,
                   const Progress& progress = {});

/// The same where it is decided in what the motion is computed.
Transient simulate_in_space(const System& system, const Equilibrium& equilibrium,
                            const std::vector<PiecewisePolynomial>& drives, const TransientOptions& options,
                            const Progress& progress, const RunObserverIn<3>& observer = {});
Transient simulate_in_plane(const assembly::PlanarSystem& plane, const Equilibrium& equilibrium,
                            const std::vector<PiecewisePolynomial>& drives, const TransientOptions& options,
                            const Progress& progress, const RunObserverIn<2>& observer = {});

/// Number of steps from start to end.
/// @throws InvalidParameter if step, end or the number of drives is wrong.
Eigen::Index number_of_steps(std::size_t n_joints, const std::vector<PiecewisePolynomial>& drives,
                             const TransientOptions& options);

/// Joint drives as drive values for the stepper; locked joints stay where the state has them.
template <int D>
integrators::Drives drives_of_joints(const assembly::SystemIn<D>& system, const assembly::StateIn<D>& state,
                                     std::vector<PiecewisePolynomial> drives);

}  // namespace flexarm::simulation
