#include "flexarm/joints/joint_constraint.hpp"

namespace flexarm::joints {

using namespace geometry;

Vector6d motion_twist(JointType type, const Vector3d& axis) {
  Vector6d twist = Vector6d::Zero();
  if (type == JointType::revolute) twist.tail<3>() = axis.normalized();
  if (type == JointType::prismatic) twist.head<3>() = axis.normalized();
  return twist;
}

JointConstraint::JointConstraint(JointType type, int node_a, const Frame& X_a, int node_b, const Frame& X_b,
                                 const Vector3d& axis, int coordinate)
    : type_(type),
      node_a_(node_a),
      node_b_(node_b),
      coordinate_(coordinate),
      X_b_(X_b),
      X_a_inverse_(X_a.inverse()),
      Ad_a_(adjoint(X_a.inverse())),
      Ad_b_(adjoint(X_b.inverse())),
      twist_(motion_twist(type, axis)) {}

Frame JointConstraint::back(double theta) const { return exp6(-theta * twist_); }

Vector6d JointConstraint::violation(const Frame& H_a, const Frame& H_b, double theta) const {
  const Frame apart = X_a_inverse_ * relative(H_a, H_b) * X_b_;
  if (type_ == JointType::spherical) {
    Vector6d phi = Vector6d::Zero();
    phi.head<3>() = apart.R.transpose() * apart.x;  // eq. (3)
    return phi;
  }
  return log6(back(theta) * apart);  // eq. (1)
}

JointConstraint::Jacobian JointConstraint::jacobian(const Frame& H_a, const Frame& H_b, double theta) const {
  if (type_ == JointType::spherical) {
    const Matrix3d R = (X_a_inverse_ * relative(H_a, H_b) * X_b_).R;
    return {-adjoint(Frame::rotation(R.transpose())) * Ad_a_, Ad_b_, twist_};
  }
  return {-adjoint(back(theta)) * Ad_a_, Ad_b_, -twist_};  // eq. (2)
}

JointConstraint::Forces JointConstraint::forces(const Frame& H_a, const Frame& H_b, double theta,
                                                const Vector6d& multipliers) const {
  Forces f;
  f.b = Ad_b_.transpose() * multipliers;
  if (node_a_ == ground && type_ != JointType::spherical) {
    f.a = -Ad_a_.transpose() * (adjoint(back(theta)).transpose() * multipliers);
  } else {
    f.a = jacobian(H_a, H_b, theta).a.transpose() * multipliers;
  }
  return f;
}

JointConstraint::GeometricStiffness JointConstraint::geometric_stiffness(const Frame& H_a, const Frame& H_b,
                                                                         double theta,
                                                                         const Vector6d& multipliers) const {
  GeometricStiffness K;
  if (type_ == JointType::spherical) {
    // Φ_aᵀ λ = −Ad_aᵀ (R λ, 0); a relative turn δ of B against A, in B's axes, gives d(R λ) = −R λ~ δ.
    const Matrix3d R = (X_a_inverse_ * relative(H_a, H_b) * X_b_).R;
    Eigen::Matrix<double, 6, 3> by_turn = Eigen::Matrix<double, 6, 3>::Zero();
    by_turn.topRows<3>() = R * skew(multipliers.head<3>());
    by_turn = Ad_a_.transpose() * by_turn;
    K.a_b = by_turn * Ad_b_.bottomRows<3>();
    K.a_a = -by_turn * R.transpose() * Ad_a_.bottomRows<3>();
    return K;
  }
  K.a_theta = Ad_a_.transpose() * (adjoint(back(theta)).transpose() * ad_transpose(twist_, multipliers));
  return K;
}

}  // namespace flexarm::joints
