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
/// axes_agree() tells. With increments (ρ, ω) of A and B in their own axes,
///
///     δ(e · p) = Rᵀe · ρ_b − e · ρ_a − (p × e) · ω_a                                                 (3)
///     δ(e · R w) = (w × Rᵀe) · ω_b − (R w × e) · ω_a                                                 (4)
///
/// In a plane (D = 2) the same two forms hold with arrows of the plane: a pin has two of (1), what locks the
/// turn one of (2). Source: [Nikravesh1988] for the conditions.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "flexarm/geometry/plane.hpp"
#include "flexarm/geometry/se3.hpp"

namespace flexarm::joints {

using geometry::Frame;
using geometry::FrameIn;
using geometry::Matrix6d;
using geometry::Point;
using geometry::Rotation;
using geometry::Twist;
using geometry::TwistMatrix;
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

template <int D>
class ClosureConstraintIn {
 public:
  static constexpr int ground = -1, n = geometry::freedoms<D>;
  using FrameD = FrameIn<D>;
  using PointD = Point<D>;
  using TwistD = Twist<D>;
  using TwistMatrixD = TwistMatrix<D>;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, n, 0, 6, n>;

  /// @param node_a, node_b nodes or `ground`; @param X_a, X_b the frames A and B in the nodes' frames.
  /// @param axis in A (u), @param second_axis of a universal closure, in B (v); @param length ℓ [m].
  ClosureConstraintIn(ClosureType type, int node_a, const Frame& X_a, int node_b, const Frame& X_b,
                      const Vector3d& axis, const Vector3d& second_axis, double length)
    requires(D == 3);

  int node_a() const { return node_a_; }
  int node_b() const { return node_b_; }
  int size() const { return static_cast<int>(conditions_.size()); }
  /// True if the origins meet, and A and B may turn against each other.
  bool is_ball() const { return size() == D && !conditions_.back().turns; }
  /// True if A and B cannot move against each other.
  bool is_rigid() const { return size() == n; }

  bool operator==(const ClosureConstraintIn&) const = default;

  /// Equations (1), (2).
  Conditions residual(const FrameD& H_a, const FrameD& H_b) const;

  /// The same as a distance [m] and an angle [rad] for a reader.
  struct Misclosure {
    double distance, angle;
  };
  Misclosure misclosure(const FrameD& H_a, const FrameD& H_b) const;

  /// True unless an axis that (2) aligns points the opposite way.
  bool axes_agree(const FrameD& H_a, const FrameD& H_b) const;

  /// The angle by which B turns about the axis of a revolute closure, in A; within half a turn.
  double hinge_angle(const FrameD& H_a, const FrameD& H_b) const
    requires(D == 3);

  /// Equations (3), (4) for increments of the nodes.
  struct Jacobian {
    Rows a, b;
  };
  Jacobian jacobian(const FrameD& H_a, const FrameD& H_b) const;

  /// Jᵀλ, and the conditions.
  struct Response {
    TwistD a, b;
    Conditions residual;
  };
  Response respond(const FrameD& H_a, const FrameD& H_b, const Conditions& lambda) const;

  /// Derivatives of Jᵀλ at fixed λ with respect to the increments: rows and columns of nodes a and b.
  struct GeometricStiffness {
    TwistMatrixD a_a, a_b, b_a, b_b;
  };
  GeometricStiffness geometric_stiffness(const FrameD& H_a, const FrameD& H_b,
                                         const Conditions& lambda) const;

  /// Velocities of both nodes, or accelerations.
  struct Rates {
    TwistD a, b;
  };
  /// The second derivative of the conditions.
  Conditions acceleration(const FrameD& H_a, const FrameD& H_b, const Rates& v, const Rates& v_dot) const;

  /// Force and moment that the closure puts on b at the origin of B, base axes.
  TwistD wrench_on_b(const FrameD& H_a, const FrameD& H_b, const Conditions& lambda) const;
  PointD place_on_b(const FrameD& H_b) const { return H_b * X_b_.x; }  ///< origin of B, base axes
  FrameD frame_at_a(const FrameD& H_a) const { return H_a * X_a_; }    ///< A
  const FrameD& frame_a() const { return X_a_; }                       ///< X_a
  const FrameD& frame_b() const { return X_b_; }                       ///< X_b
  /// R.
  Rotation<D> rotation(const FrameD& H_a, const FrameD& H_b) const { return place(H_a, H_b).R; }

  /// The conditions within a plane, and by columns which combinations of those of space they are.
  struct PlanarPart;
  /// Nothing if some condition lies neither within the plane nor across it. @param at_a, at_b axes of the
  /// plane, seen from nodes a and b
  std::optional<PlanarPart> planar_part(const geometry::PlaneAxes& at_a,
                                        const geometry::PlaneAxes& at_b) const
    requires(D == 3);

 private:
  struct Condition {
    bool turns;  // form (2)
    PointD e, w;
    bool operator==(const Condition&) const = default;
  };
  struct Placement {
    FrameD A, B;
    Rotation<D> R;
    PointD p;
  };
  template <int>
  friend class ClosureConstraintIn;

  ClosureConstraintIn(int node_a, const FrameD& X_a, int node_b, const FrameD& X_b, double length)
      : node_a_(node_a),
        node_b_(node_b),
        X_a_(X_a),
        X_b_(X_b),
        X_a_inverse_(X_a.inverse()),
        X_b_inverse_(X_b.inverse()),
        length_(length) {}
  Placement place(const FrameD& H_a, const FrameD& H_b) const;
  Rows on_b(const Placement& at) const;  // of frame B

  int node_a_, node_b_;
  FrameD X_a_, X_b_, X_a_inverse_, X_b_inverse_;
  double length_;
  std::vector<Condition> conditions_;
  std::vector<std::pair<PointD, PointD>> aligned_;  // axes of A and B that must point the same way
};

using ClosureConstraint = ClosureConstraintIn<3>;

template <int D>
struct ClosureConstraintIn<D>::PlanarPart {
  ClosureConstraintIn<2> closure;
  Eigen::MatrixXd combinations;
};

}  // namespace flexarm::joints
