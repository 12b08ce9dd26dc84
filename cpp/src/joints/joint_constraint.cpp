#include "flexarm/joints/joint_constraint.hpp"

namespace flexarm::joints {

using namespace geometry;

Vector6d motion_twist(JointType type, const Vector3d& axis) {
  Vector6d twist = Vector6d::Zero();
  if (type == JointType::revolute) twist.tail<3>() = axis.normalized();
  if (type == JointType::prismatic) twist.head<3>() = axis.normalized();
  return twist;
}

template <int D>
JointConstraintIn<D>::JointConstraintIn(JointType type, int node_a, const FrameD& X_a, int node_b,
                                        const FrameD& X_b, const TwistD& twist, int coordinate)
    : type_(type),
      node_a_(node_a),
      node_b_(node_b),
      coordinate_(coordinate),
      X_b_(X_b),
      X_a_inverse_(X_a.inverse()),
      X_b_inverse_(X_b.inverse()),
      Ad_a_(adjoint<D>(X_a.inverse())),
      Ad_b_(adjoint<D>(X_b.inverse())),
      twist_(twist) {}

template <int D>
Twist<D> JointConstraintIn<D>::violation(const FrameD& H_a, const FrameD& H_b, double theta) const {
  const FrameD apart = X_a_inverse_ * relative<D>(H_a, H_b) * X_b_;
  if (type_ == JointType::spherical) {
    TwistD phi = TwistD::Zero();
    phi.template head<D>() = apart.R.transpose() * apart.x;  // eq. (3)
    return phi;
  }
  return logarithm<D>(coordinate_ < 0 ? apart : back(theta) * apart);  // eq. (1)
}

template <int D>
typename JointConstraintIn<D>::Jacobian JointConstraintIn<D>::jacobian(const FrameD& H_a, const FrameD& H_b,
                                                                       double theta) const {
  if (type_ == JointType::spherical) {
    const Rotation<D> R = (X_a_inverse_ * relative<D>(H_a, H_b) * X_b_).R;
    return {-adjoint<D>(FrameD::rotation(R.transpose())) * Ad_a_, Ad_b_, twist_};
  }
  return {-adjoint<D>(back(theta)) * Ad_a_, Ad_b_, -twist_};  // eq. (2)
}

template <int D>
typename JointConstraintIn<D>::Forces JointConstraintIn<D>::forces(const FrameD& H_a, const FrameD& H_b,
                                                                   double theta,
                                                                   const TwistD& multipliers) const {
  Forces f;
  f.b = Ad_b_.transpose() * multipliers;
  if (type_ == JointType::spherical) {
    f.a = jacobian(H_a, H_b, theta).a.transpose() * multipliers;
  } else if (coordinate_ < 0) {
    f.a = -Ad_a_.transpose() * multipliers;
  } else {
    f.a = -Ad_a_.transpose() * (adjoint<D>(back(theta)).transpose() * multipliers);
  }
  return f;
}

template <int D>
Twist<D> JointConstraintIn<D>::acceleration(const FrameD& H_a, const FrameD& H_b, double theta,
                                            const Rates& v, const Rates& v_dot) const {
  if (type_ == JointType::spherical) {
    const Jacobian J = jacobian(H_a, H_b, theta);
    TwistD c = J.a * v_dot.a + J.b * v_dot.b;
    const TwistD u = -J.a * v.a, of_b = J.b * v.b;
    const Turn<D> turn = of_b.template tail<turns<D>>() - u.template tail<turns<D>>();
    c.template head<D>() += turn_cross<D>(turn, u.template head<D>());
    return c;
  }
  TwistD c = Ad_b_ * v_dot.b - twist_ * v_dot.theta;
  if (node_a_ == ground) return c;
  const FrameD turned = coordinate_ < 0 ? FrameD{} : back(theta);
  const TwistD on_a = Ad_a_ * v.a, on_a_dot = Ad_a_ * v_dot.a;
  const TwistD u = adjoint_product<D>(turned, on_a);
  return c - adjoint_product<D>(turned, on_a_dot) + v.theta * ad_product<D>(twist_, u);
}

template <int D>
typename JointConstraintIn<D>::GeometricStiffness JointConstraintIn<D>::geometric_stiffness(
    const FrameD& H_a, const FrameD& H_b, double theta, const TwistD& multipliers) const {
  GeometricStiffness K;
  if (type_ == JointType::spherical) {
    // Φ_aᵀ λ = −Ad_aᵀ (R λ, 0); a relative turn δ of B against A, in B's axes, gives d(R λ) = −R λ~ δ.
    const Rotation<D> R = (X_a_inverse_ * relative<D>(H_a, H_b) * X_b_).R;
    Eigen::Matrix<double, n, turns<D>> by_turn = Eigen::Matrix<double, n, turns<D>>::Zero();
    by_turn.template topRows<D>() = R * lever_matrix<D>(multipliers.template head<D>());
    by_turn = (Ad_a_.transpose() * by_turn).eval();
    K.a_b = by_turn * Ad_b_.template bottomRows<turns<D>>();
    Rotation<3> back_turn = Rotation<3>::Identity();  // of rotations: R in space, 1 in the plane
    if constexpr (D == 3) back_turn = R.transpose();
    K.a_a = -by_turn * back_turn.topLeftCorner<turns<D>, turns<D>>() * Ad_a_.template bottomRows<turns<D>>();
    return K;
  }
  K.a_theta =
      Ad_a_.transpose() * (adjoint<D>(back(theta)).transpose() * ad_transpose<D>(twist_, multipliers));
  return K;
}

template class JointConstraintIn<2>;
template class JointConstraintIn<3>;

}  // namespace flexarm::joints
