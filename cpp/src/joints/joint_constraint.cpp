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
      at_{X_b, X_a.inverse(), X_b.inverse(), twist, adjoint<D>(X_a.inverse()), adjoint<D>(X_b.inverse())} {}

template <int D>
Twist<D> JointConstraintIn<D>::violation(const FrameD& H_a, const FrameD& H_b, double theta) const {
  const FrameD apart = at_.X_a_inverse * relative<D>(H_a, H_b) * at_.X_b;
  if (type_ == JointType::spherical) {
    TwistD phi = TwistD::Zero();
    phi.template head<D>() = apart.R.transpose() * apart.x;  // eq. (3)
    return phi;
  }
  return logarithm<D>(coordinate_ < 0 ? apart : at_.back(theta) * apart);  // eq. (1)
}

template <int D>
typename JointConstraintIn<D>::Jacobian JointConstraintIn<D>::jacobian(const FrameD& H_a, const FrameD& H_b,
                                                                       double theta) const {
  if (type_ == JointType::spherical) {
    const Rotation<D> R = (at_.X_a_inverse * relative<D>(H_a, H_b) * at_.X_b).R;
    return {-adjoint<D>(FrameD::rotation(R.transpose())) * at_.Ad_a, at_.Ad_b, at_.twist};
  }
  return {-adjoint<D>(at_.back(theta)) * at_.Ad_a, at_.Ad_b, -at_.twist};  // eq. (2)
}

template <int D>
typename JointConstraintIn<D>::Forces JointConstraintIn<D>::forces(const FrameD& H_a, const FrameD& H_b,
                                                                   double theta,
                                                                   const TwistD& multipliers) const {
  Forces f;
  f.b = at_.Ad_b.transpose() * multipliers;
  if (type_ == JointType::spherical) {
    f.a = jacobian(H_a, H_b, theta).a.transpose() * multipliers;
  } else if (coordinate_ < 0) {
    f.a = -at_.Ad_a.transpose() * multipliers;
  } else {
    f.a = -at_.Ad_a.transpose() * (adjoint<D>(at_.back(theta)).transpose() * multipliers);
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
  return at_.acceleration(node_a_ == ground, coordinate_ >= 0, theta, v, v_dot);
}

template <int D>
typename JointConstraintIn<D>::GeometricStiffness JointConstraintIn<D>::geometric_stiffness(
    const FrameD& H_a, const FrameD& H_b, double theta, const TwistD& multipliers) const {
  GeometricStiffness K;
  if (type_ == JointType::spherical) {
    // Φ_aᵀ λ = −Ad_aᵀ (R λ, 0); a relative turn δ of B against A, in B's axes, gives d(R λ) = −R λ~ δ.
    const Rotation<D> R = (at_.X_a_inverse * relative<D>(H_a, H_b) * at_.X_b).R;
    Eigen::Matrix<double, n, turns<D>> by_turn = Eigen::Matrix<double, n, turns<D>>::Zero();
    by_turn.template topRows<D>() = R * lever_matrix<D>(multipliers.template head<D>());
    by_turn = (at_.Ad_a.transpose() * by_turn).eval();
    K.a_b = by_turn * at_.Ad_b.template bottomRows<turns<D>>();
    Rotation<3> back_turn = Rotation<3>::Identity();  // of rotations: R in space, 1 in the plane
    if constexpr (D == 3) back_turn = R.transpose();
    K.a_a =
        -by_turn * back_turn.topLeftCorner<turns<D>, turns<D>>() * at_.Ad_a.template bottomRows<turns<D>>();
    return K;
  }
  K.a_theta = at_.Ad_a.transpose() *
              (adjoint<D>(at_.back(theta)).transpose() * ad_transpose<D>(at_.twist, multipliers));
  return K;
}

template class JointConstraintIn<2>;
template class JointConstraintIn<3>;

}  // namespace flexarm::joints
