#include "flexarm/joints/closure_constraint.hpp"

#include <algorithm>
#include <cmath>

#include "flexarm/errors.hpp"

namespace flexarm::joints {

using namespace geometry;

ClosureConstraint::ClosureConstraint(ClosureType type, int node_a, const Frame& X_a, int node_b,
                                     const Frame& X_b, const Vector3d& axis, const Vector3d& second_axis,
                                     double length)
    : node_a_(node_a),
      node_b_(node_b),
      X_a_(X_a),
      X_b_(X_b),
      Ad_a_(adjoint<3>(X_a.inverse())),
      Ad_b_(adjoint<3>(X_b.inverse())),
      length_(length) {
  const bool has_axis = type != ClosureType::spherical && type != ClosureType::fixed;
  if (has_axis && !(axis.norm() > 0)) throw InvalidParameter("axis must not be zero");
  const Vector3d u = has_axis ? Vector3d(axis.normalized()) : Vector3d::UnitZ();
  Vector3d::Index smallest;
  u.cwiseAbs().minCoeff(&smallest);
  const Vector3d e1 = u.cross(Vector3d::Unit(smallest)).normalized(), e2 = u.cross(e1);
  const auto meet = [&](const Vector3d& e) { conditions_.push_back({false, e, Vector3d::Zero()}); };
  const auto turn = [&](const Vector3d& e, const Vector3d& w) { conditions_.push_back({true, e, w}); };
  switch (type) {
    case ClosureType::revolute:
    case ClosureType::spherical:
    case ClosureType::universal:
    case ClosureType::fixed:
      for (int k = 0; k < 3; ++k) meet(Vector3d::Unit(k));
      break;
    default:
      meet(e1);
      meet(e2);
  }
  switch (type) {
    case ClosureType::revolute:
    case ClosureType::cylindrical:
      turn(e1, u);
      turn(e2, u);
      aligned_ = {{u, u}};
      break;
    case ClosureType::universal: {
      const Vector3d v = second_axis - second_axis.dot(u) * u;
      if (!(v.norm() > 1e-6 * second_axis.norm()) || !(second_axis.norm() > 0))
        throw InvalidParameter("the second axis must not run along the first");
      turn(u, v.normalized());
      break;
    }
    case ClosureType::fixed:
    case ClosureType::prismatic:
      turn(e1, e2);
      turn(e2, u);
      turn(u, e1);
      aligned_ = {{e1, e1}, {e2, e2}, {u, u}};
      break;
    default:
      break;
  }
}

ClosureConstraint::Placement ClosureConstraint::place(const Frame& H_a, const Frame& H_b) const {
  const Frame A = H_a * X_a_, B = H_b * X_b_;
  return {A, B, A.R.transpose() * B.R, A.R.transpose() * (B.x - A.x)};
}

Conditions ClosureConstraint::gap(const Frame& H_a, const Frame& H_b) const {
  const Placement at = place(H_a, H_b);
  Conditions phi(size());
  for (int i = 0; i < size(); ++i) {
    const Condition& c = conditions_[i];
    phi[i] = c.turns ? length_ * c.e.dot(at.R * c.w) : c.e.dot(at.p);  // eq. (1), (2)
  }
  return phi;
}

ClosureConstraint::Apart ClosureConstraint::apart(const Frame& H_a, const Frame& H_b) const {
  const Conditions phi = gap(H_a, H_b);
  double distance = 0, sine = 0;
  for (int i = 0; i < size(); ++i) (conditions_[i].turns ? sine : distance) += phi[i] * phi[i];
  double angle = std::asin(std::min(1.0, std::sqrt(sine) / length_));
  if (!right_way(H_a, H_b)) angle = std::acos(-1.0) - angle;
  return {std::sqrt(distance), angle};
}

bool ClosureConstraint::right_way(const Frame& H_a, const Frame& H_b) const {
  const Placement at = place(H_a, H_b);
  return std::all_of(aligned_.begin(), aligned_.end(),
                     [&](const auto& pair) { return pair.first.dot(at.R * pair.second) > 0; });
}

double ClosureConstraint::turn(const Frame& H_a, const Frame& H_b) const {
  const Vector3d &e1 = conditions_[3].e, &e2 = conditions_[4].e;
  const Vector3d turned = place(H_a, H_b).R * e1;
  return std::atan2(e2.dot(turned), e1.dot(turned));
}

ClosureConstraint::Rows ClosureConstraint::on_b(const Placement& at) const {
  Rows J(size(), 6);
  for (int i = 0; i < size(); ++i) {
    const Vector3d e = at.R.transpose() * conditions_[i].e;
    if (conditions_[i].turns) {
      J.row(i) << 0, 0, 0, length_ * conditions_[i].w.cross(e).transpose();  // eq. (4)
    } else {
      J.row(i) << e.transpose(), 0, 0, 0;  // eq. (3)
    }
  }
  return J;
}

ClosureConstraint::Jacobian ClosureConstraint::jacobian(const Frame& H_a, const Frame& H_b) const {
  const Placement at = place(H_a, H_b);
  Rows a(size(), 6);
  for (int i = 0; i < size(); ++i) {
    const Condition& c = conditions_[i];
    if (c.turns) {
      a.row(i) << 0, 0, 0, length_ * c.e.cross(at.R * c.w).transpose();  // eq. (4)
    } else {
      a.row(i) << -c.e.transpose(), c.e.cross(at.p).transpose();  // eq. (3)
    }
  }
  return {a * Ad_a_, on_b(at) * Ad_b_};
}

ClosureConstraint::GeometricStiffness ClosureConstraint::geometric_stiffness(const Frame& H_a,
                                                                             const Frame& H_b,
                                                                             const Conditions& lambda) const {
  const Placement at = place(H_a, H_b);
  const Matrix3d& R = at.R;
  Matrix6d aa = Matrix6d::Zero(), ab = aa, ba = aa, bb = aa;
  Vector3d n = Vector3d::Zero();
  for (int i = 0; i < size(); ++i) {
    const Condition& c = conditions_[i];
    if (!c.turns) {
      n += lambda[i] * c.e;
      continue;
    }
    const double l = length_ * lambda[i];
    const Matrix3d e = skew(c.e), w = skew(c.w);
    aa.bottomRightCorner<3, 3>() += l * e * skew(R * c.w);
    ab.bottomRightCorner<3, 3>() -= l * e * R * w;
    bb.bottomRightCorner<3, 3>() += l * w * skew(R.transpose() * c.e);
    ba.bottomRightCorner<3, 3>() -= l * w * R.transpose() * e;
  }
  const Matrix3d n_cross = skew(n);
  aa.bottomLeftCorner<3, 3>() -= n_cross;
  aa.bottomRightCorner<3, 3>() += n_cross * skew(at.p);
  ab.bottomLeftCorner<3, 3>() += n_cross * R;
  bb.topRightCorner<3, 3>() += skew(R.transpose() * n);
  ba.topRightCorner<3, 3>() -= R.transpose() * n_cross;
  return {Ad_a_.transpose() * aa * Ad_a_, Ad_a_.transpose() * ab * Ad_b_, Ad_b_.transpose() * ba * Ad_a_,
          Ad_b_.transpose() * bb * Ad_b_};
}

Conditions ClosureConstraint::convective(const Frame& H_a, const Frame& H_b, const Vector6d& v_a,
                                         const Vector6d& v_b) const {
  Conditions found(size());
  for (int i = 0; i < size(); ++i) {
    Conditions one = Conditions::Zero(size());
    one[i] = 1;
    const GeometricStiffness K = geometric_stiffness(H_a, H_b, one);
    found[i] = v_a.dot(K.a_a * v_a + K.a_b * v_b) + v_b.dot(K.b_a * v_a + K.b_b * v_b);
  }
  return found;
}

Vector6d ClosureConstraint::wrench_on_b(const Frame& H_a, const Frame& H_b, const Conditions& lambda) const {
  const Placement at = place(H_a, H_b);
  const Vector6d f = -(on_b(at).transpose() * lambda);
  Vector6d wrench;
  wrench << at.B.R * f.head<3>(), at.B.R * f.tail<3>();
  return wrench;
}

}  // namespace flexarm::joints
