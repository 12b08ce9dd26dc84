/// @file
/// Joints as constraints between two frames.
///
/// Frames A = H_a X_a and B = H_b X_b sit on nodes a and b. A joint with the unit twist ξ and its own
/// coordinate θ (revolute: rotation about an axis; prismatic: translation along it; fixed: none) demands B =
/// A exp(ξ θ), so
///
///     Φ = log(exp(−ξ θ) A⁻¹ B) = 0                              6 equations                          (1)
///     Φ_b = Ad(X_b⁻¹),  Φ_a = −Ad(exp(−ξ θ) X_a⁻¹),  Φ_θ = −ξ    where Φ = 0                          (2)
///
/// θ is a coordinate of the system, so that it counts turns, and laws and gears act on it as on any other.
/// The multipliers λ are the wrench that the joint takes, in the axes of frame B: node b feels −Φ_bᵀ λ and
/// the coordinate feels ξᵀ λ, so −ξᵀ λ is the torque about the axis on the child. A spherical joint keeps the
/// origins together,
///
///     Φ = Rᵀ p of (R, p) = A⁻¹ B,    3 equations                                                      (3)
///
/// In a plane (D = 2) equations (1)-(2) have three rows, (3) has two. Joints need not form a tree: a loop is
/// closed by one more. Sources: [Bruls2012], [Sonneville2014].
#pragma once

#include <Eigen/Core>

#include "flexarm/geometry/se3.hpp"

namespace flexarm::joints {

using geometry::Frame;
using geometry::FrameIn;
using geometry::Matrix6d;
using geometry::Twist;
using geometry::TwistMatrix;
using geometry::Vector3d;
using geometry::Vector6d;

enum class JointType { revolute, prismatic, fixed, spherical };

/// Twist ξ of a joint about or along the unit `axis`; zero without a coordinate.
Vector6d motion_twist(JointType type, const Vector3d& axis);

/// Where a joint of equations (1), (2) sits and how it moves, in any kind of numbers.
template <int D, class Real = double>
struct JointFrames {
  using FrameD = FrameIn<D, Real>;
  using TwistD = Twist<D, Real>;

  FrameD X_b, X_a_inverse, X_b_inverse;
  TwistD twist;                     ///< ξ
  TwistMatrix<D, Real> Ad_a, Ad_b;  ///< of X_a⁻¹ and X_b⁻¹

  bool operator==(const JointFrames&) const = default;

  /// exp(−ξ θ).
  FrameD back(const Real& theta) const { return geometry::exponential<D, Real>(-theta * twist); }

  /// Φ_aᵀ λ, Φ_bᵀ λ and Φ. @param moves whether there is a θ
  struct Response {
    TwistD a, b, violation;
  };
  [[gnu::always_inline]] Response respond(const FrameD& H_a, const FrameD& H_b, bool moves, const Real& theta,
                                          const TwistD& multipliers) const {
    FrameD apart = X_a_inverse * geometry::relative<D>(H_a, H_b) * X_b;
    TwistD on_parent = multipliers;
    if (moves) {
      const FrameD turned = back(theta);
      apart = turned * apart;
      on_parent = geometry::adjoint_transpose_product<D>(turned, multipliers);
    }
    return {-geometry::adjoint_transpose_product<D>(X_a_inverse, on_parent),
            geometry::adjoint_transpose_product<D>(X_b_inverse, multipliers),
            geometry::logarithm<D>(apart)};  // eq. (1), (2)
  }

  /// Velocities of both nodes and of θ, or accelerations.
  struct Rates {
    TwistD a, b;
    Real theta;
  };
  /// Φ'' where Φ = Φ' = 0. With u = −Φ_a v_a
  ///
  ///     Φ'' = Φ_a v_a' + Φ_b v_b' + Φ_θ θ'' + θ' ad(ξ) u
  TwistD acceleration(bool on_ground, bool moves, const Real& theta, const Rates& v,
                      const Rates& v_dot) const {
    const TwistD c = Ad_b * v_dot.b - twist * v_dot.theta;
    if (on_ground) return c;
    const FrameD turned = moves ? back(theta) : FrameD{};
    const TwistD on_a = Ad_a * v.a, on_a_dot = Ad_a * v_dot.a;
    const TwistD u = geometry::adjoint_product<D>(turned, on_a);
    return c - geometry::adjoint_product<D>(turned, on_a_dot) +
           v.theta * geometry::ad_product<D, Real>(twist, u);
  }
};

template <int D>
class JointConstraintIn {
 public:
  static constexpr int ground = -1;
  static constexpr int n = geometry::freedoms<D>;
  using FrameD = FrameIn<D>;
  using TwistD = Twist<D>;

  /// @param node_a node of the parent or `ground`; @param X_a, X_b joint frames in the nodes' frames.
  /// @param twist ξ, @param coordinate index of θ among the scalar coordinates, −1 if the joint has none.
  JointConstraintIn(JointType type, int node_a, const FrameD& X_a, int node_b, const FrameD& X_b,
                    const TwistD& twist, int coordinate);
  JointConstraintIn(JointType type, int node_a, const Frame& X_a, int node_b, const Frame& X_b,
                    const Vector3d& axis, int coordinate)
    requires(D == 3)
      : JointConstraintIn(type, node_a, X_a, node_b, X_b, motion_twist(type, axis), coordinate) {}

  JointType type() const { return type_; }
  int node_a() const { return node_a_; }
  int node_b() const { return node_b_; }
  int coordinate() const { return coordinate_; }
  int rows() const { return type_ == JointType::spherical ? D : n; }
  const JointFrames<D>& frames() const { return at_; }
  const TwistD& twist() const { return at_.twist; }
  FrameD frame_a() const { return at_.X_a_inverse.inverse(); }  ///< X_a
  const FrameD& frame_b() const { return at_.X_b; }             ///< X_b

  /// Φ in its first rows() entries. Equations (1), (3).
  TwistD violation(const FrameD& H_a, const FrameD& H_b, double theta) const;

  /// Equation (2): rows() rows count.
  struct Jacobian {
    TwistMatrix<D> a, b;
    TwistD theta;
  };
  Jacobian jacobian(const FrameD& H_a, const FrameD& H_b, double theta) const;

  /// Φ_aᵀ λ and Φ_bᵀ λ; Φ_θᵀ λ is −ξᵀ λ.
  struct Forces {
    TwistD a, b;
  };
  Forces forces(const FrameD& H_a, const FrameD& H_b, double theta, const TwistD& multipliers) const;

  /// Both, with exp(−ξ θ) made once.
  struct Response {
    Forces forces;
    TwistD violation;
  };
  Response respond(const FrameD& H_a, const FrameD& H_b, double theta, const TwistD& multipliers) const;

  using Rates = typename JointFrames<D>::Rates;
  /// Φ'' where Φ = Φ' = 0, from velocities and accelerations: rows() entries count. Of a spherical joint the
  /// turn of B against A times u stands in place of θ' ad(ξ) u.
  TwistD acceleration(const FrameD& H_a, const FrameD& H_b, double theta, const Rates& v,
                      const Rates& v_dot) const;

  /// Derivatives of Φ_aᵀ λ at fixed λ: with respect to θ (revolute, prismatic) and to the increments of the
  /// nodes.
  struct GeometricStiffness {
    TwistD a_theta = TwistD::Zero();
    TwistMatrix<D> a_a = TwistMatrix<D>::Zero(), a_b = TwistMatrix<D>::Zero();
  };
  GeometricStiffness geometric_stiffness(const FrameD& H_a, const FrameD& H_b, double theta,
                                         const TwistD& multipliers) const;

  bool operator==(const JointConstraintIn&) const = default;

 private:
  JointType type_;
  int node_a_, node_b_, coordinate_;
  JointFrames<D> at_;
};

using JointConstraint = JointConstraintIn<3>;

template <int D>
typename JointConstraintIn<D>::Response JointConstraintIn<D>::respond(const FrameD& H_a, const FrameD& H_b,
                                                                      double theta,
                                                                      const TwistD& multipliers) const {
  if (type_ == JointType::spherical) {
    return {forces(H_a, H_b, theta, multipliers), violation(H_a, H_b, theta)};
  }
  const auto [a, b, violated] = at_.respond(H_a, H_b, coordinate_ >= 0, theta, multipliers);
  return {{a, b}, violated};
}

}  // namespace flexarm::joints
