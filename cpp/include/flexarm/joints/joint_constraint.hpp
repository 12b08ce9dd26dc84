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
  const TwistD& twist() const { return twist_; }
  FrameD frame_a() const { return X_a_inverse_.inverse(); }  ///< X_a
  const FrameD& frame_b() const { return X_b_; }             ///< X_b

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

  /// Velocities of both nodes and of θ, or accelerations.
  struct Rates {
    TwistD a, b;
    double theta;
  };
  /// Φ'' where Φ = Φ' = 0, from velocities and accelerations: rows() entries count. With u = −Φ_a v_a
  ///
  ///     Φ'' = Φ_a v_a' + Φ_b v_b' + Φ_θ θ'' + θ' ad(ξ) u
  ///
  /// and for a spherical joint the turn of B against A times u instead.
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
  /// exp(−ξ θ).
  FrameD back(double theta) const { return geometry::exponential<D>(-theta * twist_); }

  JointType type_;
  int node_a_, node_b_, coordinate_;
  FrameD X_b_, X_a_inverse_, X_b_inverse_;
  TwistMatrix<D> Ad_a_, Ad_b_;  // of X_a⁻¹ and X_b⁻¹
  TwistD twist_;
};

using JointConstraint = JointConstraintIn<3>;

template <int D>
typename JointConstraintIn<D>::Response JointConstraintIn<D>::respond(const FrameD& H_a, const FrameD& H_b,
                                                                      double theta,
                                                                      const TwistD& multipliers) const {
  if (type_ == JointType::spherical) {
    return {forces(H_a, H_b, theta, multipliers), violation(H_a, H_b, theta)};
  }
  FrameD apart = X_a_inverse_ * geometry::relative<D>(H_a, H_b) * X_b_;
  TwistD on_parent = multipliers;
  if (coordinate_ >= 0) {
    const FrameD turned = back(theta);
    apart = turned * apart;
    on_parent = geometry::adjoint_transpose_product<D>(turned, multipliers);
  }
  return {{-geometry::adjoint_transpose_product<D>(X_a_inverse_, on_parent),
           geometry::adjoint_transpose_product<D>(X_b_inverse_, multipliers)},
          geometry::logarithm<D>(apart)};  // eq. (1), (2)
}

}  // namespace flexarm::joints
