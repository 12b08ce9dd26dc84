/// @file
/// An arm that moves in a plane, with three coordinates a node.
///
/// Every node has axes of the plane (geometry/plane.hpp) that do not change while it moves within it. With P
/// and Q, the twists within and across the plane, of all nodes together, the motion stays in the plane if
///
///     Qᵀ M P = 0,  Qᵀ K P = 0,  Qᵀ C P = 0      of every element                                     (1)
///
/// if the twists and places of the joints lie in it (P ξ₂ = ξ), if every condition of a closure lies within
/// it or across it, and if gravity and loads do. Then the
/// equations of motion of space, seen by P, are those of the plane with M₂ = Pᵀ M P and so on, and across the
/// plane nothing moves. An arm is planar exactly if (1) holds: no list of kinds of arms is needed. Internal
/// modes of a super-element that the plane does not move stay at rest and drop out.
///
/// Of closures the plane has fewer conditions: two of a pin, where a flat loop in space repeats three. Loops
/// that repeat conditions within the plane are left to space.
///
/// Couplings are compared with what they couple: |q A p| against √(A_q A_p), lengths counted in parts of the
/// arm's reach. What (1) neglects returns to the plane as its square.
#pragma once

#include <memory>
#include <string>

#include "flexarm/assembly/system.hpp"
#include "flexarm/geometry/plane.hpp"

namespace flexarm::assembly {

using geometry::PlaneAxes;

class PlanarSystem : public SystemIn<2> {
 public:
  /// The arm's equations in the plane of motion about a state, or nothing and why.
  struct Attempt {
    std::unique_ptr<PlanarSystem> system;
    std::string obstacle;
  };
  static Attempt about(const System& system, const State& state, const Loads& loads);

  const PlaneAxes& base_axes() const { return base_; }
  const PlaneAxes& node_axes(int node) const { return axes_[node]; }
  double node_distance(int node) const { return distance_[node]; }  ///< from the plane through the base
  const PlaneAxes& point_axes(int point) const { return point_axes_[point]; }
  double point_distance(int point) const { return point_distance_[point]; }
  /// Of joints on the ground, then of closures, by their places among the constraints.
  double ground_distance(std::size_t constraint) const { return ground_distance_[constraint]; }

  /// Whether states of this system are states of another one too: same axes, same scalar coordinates.
  bool same_coordinates(const PlanarSystem& other) const;

  StateIn<2> part(const State& state) const;
  LoadsIn<2> part(const Loads& loads) const;
  /// The state in space; modes across the plane, which rest, are those of `start`.
  State embed(const StateIn<2>& state, const State& start) const;

 private:
  friend class Projection;
  PlanarSystem() = default;

  PlaneAxes base_;
  std::vector<PlaneAxes> axes_, point_axes_, joint_axes_;
  std::vector<double> distance_, point_distance_, ground_distance_;
  Eigen::MatrixXd scalars_;   // space by plane: which combination of scalar coordinates each one is
  Eigen::MatrixXd closings_;  // space by plane: the same of the multipliers of closures
};

}  // namespace flexarm::assembly
