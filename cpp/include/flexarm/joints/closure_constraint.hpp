/// @file
/// Closures: conditions between two frames that close a loop in the tree of joints.
///
/// Frames A = H_a X_a and B = H_b X_b sit on nodes a and b. With p and R the position and rotation of B in A,
/// every condition is one of two forms that are exact for any placement:
///
///     φ = e · p                 a distance along e, fixed in A                                       (1)
///     φ = ℓ e · R w             an angle between e, fixed in A, and w, fixed in B, that must be right (2)
///
/// ℓ is a length of the arm, so that all conditions are lengths. With e₁, e₂ across the unit axis u and v an
/// axis of B across u:
///
///     spherical  p = 0                          revolute      p = 0, e_i · R u = 0
///     universal  p = 0, u · R v = 0             cylindrical   e_i · p = 0, e_i · R u = 0
///     fixed      p = 0, R = 1                   prismatic     e_i · p = 0, R = 1
///     point_on_line  e_i · p = 0
///
/// R = 1 is e₁ · R e₂ = e₂ · R e₃ = e₃ · R e₁ = 0. (2) also holds where R turns an axis round by half a turn;
/// right_way() tells. With increments (ρ, ω) of A and B in their own axes,
///
///     δ(e · p) = Rᵀe · ρ_b − e · ρ_a − (p × e) · ω_a                                                 (3)
///     δ(e · R w) = (w × Rᵀe) · ω_b − (R w × e) · ω_a                                                 (4)
///
/// Source: [Nikravesh1988] for the conditions.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "flexarm/geometry/se3.hpp"

namespace flexarm::joints {

using geometry::Frame;
using geometry::Matrix6d;
using geometry::Vector3d;
using geometry::Vector6d;

/// point_on_beam is a point_on_line while the beam is straight; `assembly/beam_slide.hpp` has its conditions.
enum class ClosureType {
  revolute,
  spherical,
  universal,
  cylindrical,
  prismatic,
  fixed,
  point_on_line,
  point_on_beam
};

/// Up to six numbers, one a condition.
using Conditions = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

class ClosureConstraint {
 public:
  static constexpr int ground = -1;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 6, 0, 6, 6>;

  /// @param node_a, node_b nodes or `ground`; @param X_a, X_b the frames A and B in the nodes' frames.
  /// @param axis in A (u), @param second_axis of a universal closure, in B (v); @param length ℓ [m].
  ClosureConstraint(ClosureType type, int node_a, const Frame& X_a, int node_b, const Frame& X_b,
                    const Vector3d& axis, const Vector3d& second_axis, double length);

  int node_a() const { return node_a_; }
  int node_b() const { return node_b_; }
  int size() const { return static_cast<int>(conditions_.size()); }

  bool operator==(const ClosureConstraint&) const = default;

  /// Equations (1), (2).
  Conditions gap(const Frame& H_a, const Frame& H_b) const;

  /// The same as a distance [m] and an angle [rad] for a reader.
  struct Apart {
    double distance, angle;
  };
  Apart apart(const Frame& H_a, const Frame& H_b) const;

  /// True unless an axis that (2) aligns points the opposite way.
  bool right_way(const Frame& H_a, const Frame& H_b) const;

  /// The angle by which B turns about the axis of a revolute closure, in A; within half a turn.
  double turn(const Frame& H_a, const Frame& H_b) const;

  /// Equations (3), (4) for increments of the nodes.
  struct Jacobian {
    Rows a, b;
  };
  Jacobian jacobian(const Frame& H_a, const Frame& H_b) const;

  /// Derivatives of Jᵀλ at fixed λ with respect to the increments: rows and columns of nodes a and b.
  struct GeometricStiffness {
    Matrix6d a_a, a_b, b_a, b_b;
  };
  GeometricStiffness geometric_stiffness(const Frame& H_a, const Frame& H_b, const Conditions& lambda) const;

  /// (dJ/dt) v: what the second derivative of the conditions has beside J v'.
  Conditions convective(const Frame& H_a, const Frame& H_b, const Vector6d& v_a, const Vector6d& v_b) const;

  /// Force and moment that the closure puts on b at the origin of B, base axes.
  Vector6d wrench_on_b(const Frame& H_a, const Frame& H_b, const Conditions& lambda) const;
  Vector3d place_on_b(const Frame& H_b) const { return H_b * X_b_.x; }  ///< origin of B, base axes
  Frame frame_at_a(const Frame& H_a) const { return H_a * X_a_; }       ///< A

 private:
  struct Condition {
    bool turns;  // form (2)
    Vector3d e, w;
    bool operator==(const Condition&) const = default;
  };
  struct Placement {
    Frame A, B;
    Eigen::Matrix3d R;
    Vector3d p;
  };
  Placement place(const Frame& H_a, const Frame& H_b) const;
  Rows on_b(const Placement& at) const;  // of frame B

  int node_a_, node_b_;
  Frame X_a_, X_b_;
  Matrix6d Ad_a_, Ad_b_;  // of X_a⁻¹ and X_b⁻¹
  double length_;
  std::vector<Condition> conditions_;
  std::vector<std::pair<Vector3d, Vector3d>> aligned_;  // axes of A and B that must point the same way
};

}  // namespace flexarm::joints
