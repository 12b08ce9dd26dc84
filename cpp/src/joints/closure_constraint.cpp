#include "flexarm/joints/closure_constraint.hpp"

#include <algorithm>
#include <cmath>

#include "flexarm/errors.hpp"

namespace flexarm::joints {

using namespace geometry;

template <int D>
ClosureConstraintIn<D>::ClosureConstraintIn(ClosureType type, int node_a, const Frame& X_a, int node_b,
                                            const Frame& X_b, const Vector3d& axis,
                                            const Vector3d& second_axis, double length)
  requires(D == 3)
    : ClosureConstraintIn(node_a, X_a, node_b, X_b, length) {
  const bool has_axis = type != ClosureType::spherical && type != ClosureType::fixed;
  if (has_axis && !(axis.norm() > 0)) throw InvalidParameter("axis must not be zero");
  const Vector3d u = has_axis ? Vector3d(axis.normalized()) : Vector3d::UnitZ();
  Vector3d::Index smallest;
  u.cwiseAbs().minCoeff(&smallest);
  const Vector3d e1 = u.cross(Vector3d::Unit(smallest)).normalized(), e2 = u.cross(e1);
  const auto add_distance = [&](const Vector3d& e) { conditions_.push_back({false, e, Vector3d::Zero()}); };
  const auto add_angle = [&](const Vector3d& e, const Vector3d& w) { conditions_.push_back({true, e, w}); };
  switch (type) {
    case ClosureType::revolute:
    case ClosureType::spherical:
    case ClosureType::universal:
    case ClosureType::fixed:
      for (int k = 0; k < 3; ++k) add_distance(Vector3d::Unit(k));
      break;
    default:
      add_distance(e1);
      add_distance(e2);
  }
  switch (type) {
    case ClosureType::revolute:
    case ClosureType::cylindrical:
      add_angle(e1, u);
      add_angle(e2, u);
      aligned_ = {{u, u}};
      break;
    case ClosureType::universal: {
      const Vector3d v = second_axis - second_axis.dot(u) * u;
      if (!(v.norm() > 1e-6 * second_axis.norm()) || !(second_axis.norm() > 0))
        throw InvalidParameter("the second axis must not run along the first");
      add_angle(u, v.normalized());
      break;
    }
    case ClosureType::fixed:
    case ClosureType::prismatic:
      add_angle(e1, e2);
      add_angle(e2, u);
      add_angle(u, e1);
      aligned_ = {{e1, e1}, {e2, e2}, {u, u}};
      break;
    default:
      break;
  }
}

template <int D>
typename ClosureConstraintIn<D>::Placement ClosureConstraintIn<D>::place(const FrameD& H_a,
                                                                         const FrameD& H_b) const {
  const FrameD A = H_a * X_a_, B = H_b * X_b_;
  return {A, B, A.R.transpose() * B.R, A.R.transpose() * (B.x - A.x)};
}

template <int D>
Conditions ClosureConstraintIn<D>::residual(const FrameD& H_a, const FrameD& H_b) const {
  const Placement at = place(H_a, H_b);
  Conditions phi(size());
  for (int i = 0; i < size(); ++i) {
    const Condition& c = conditions_[i];
    phi[i] = c.turns ? length_ * c.e.dot(at.R * c.w) : c.e.dot(at.p);  // eq. (1), (2)
  }
  return phi;
}

template <int D>
typename ClosureConstraintIn<D>::Misclosure ClosureConstraintIn<D>::misclosure(const FrameD& H_a,
                                                                               const FrameD& H_b) const {
  const Conditions phi = residual(H_a, H_b);
  double distance = 0, sine = 0;
  for (int i = 0; i < size(); ++i) (conditions_[i].turns ? sine : distance) += phi[i] * phi[i];
  double angle = std::asin(std::min(1.0, std::sqrt(sine) / length_));
  if (!axes_agree(H_a, H_b)) angle = std::acos(-1.0) - angle;
  return {std::sqrt(distance), angle};
}

template <int D>
bool ClosureConstraintIn<D>::axes_agree(const FrameD& H_a, const FrameD& H_b) const {
  const Placement at = place(H_a, H_b);
  return std::all_of(aligned_.begin(), aligned_.end(),
                     [&](const auto& pair) { return pair.first.dot(at.R * pair.second) > 0; });
}

template <int D>
double ClosureConstraintIn<D>::hinge_angle(const FrameD& H_a, const FrameD& H_b) const
  requires(D == 3)
{
  const Vector3d &e1 = conditions_.at(3).e, &e2 = conditions_.at(4).e;  // behind p = 0
  const Vector3d turned = place(H_a, H_b).R * e1;
  return std::atan2(e2.dot(turned), e1.dot(turned));
}

template <int D>
typename ClosureConstraintIn<D>::Rows ClosureConstraintIn<D>::on_b(const Placement& at) const {
  Rows J = Rows::Zero(size(), n);
  for (int i = 0; i < size(); ++i) {
    const PointD e = at.R.transpose() * conditions_[i].e;
    if (conditions_[i].turns) {
      J.row(i).template tail<turns<D>>() =
          length_ * moment_of<D>(conditions_[i].w, e).transpose();  // eq. (4)
    } else {
      J.row(i).template head<D>() = e.transpose();  // eq. (3)
    }
  }
  return J;
}

template <int D>
typename ClosureConstraintIn<D>::Jacobian ClosureConstraintIn<D>::jacobian(const FrameD& H_a,
                                                                           const FrameD& H_b) const {
  const Placement at = place(H_a, H_b);
  Rows a = Rows::Zero(size(), n);
  for (int i = 0; i < size(); ++i) {
    const Condition& c = conditions_[i];
    if (c.turns) {
      a.row(i).template tail<turns<D>>() = length_ * moment_of<D>(c.e, at.R * c.w).transpose();  // eq. (4)
    } else {
      a.row(i) << -c.e.transpose(), moment_of<D>(c.e, at.p).transpose();  // eq. (3)
    }
  }
  return {a * adjoint<D>(X_a_inverse_), on_b(at) * adjoint<D>(X_b_inverse_)};
}

template <int D>
typename ClosureConstraintIn<D>::Response ClosureConstraintIn<D>::respond(const FrameD& H_a,
                                                                          const FrameD& H_b,
                                                                          const Conditions& lambda) const {
  const Placement at = place(H_a, H_b);
  Response found{TwistD::Zero(), TwistD::Zero(), Conditions(size())};
  PointD force = PointD::Zero();
  for (int i = 0; i < size(); ++i) {
    const Condition& c = conditions_[i];
    if (!c.turns) {
      force += lambda[i] * c.e;
      found.residual[i] = c.e.dot(at.p);  // eq. (1)
      continue;
    }
    const PointD Rw = at.R * c.w;
    const double l = length_ * lambda[i];
    found.a.template tail<turns<D>>() += l * moment_of<D>(c.e, Rw);
    found.b.template tail<turns<D>>() += l * moment_of<D>(c.w, at.R.transpose() * c.e);
    found.residual[i] = length_ * c.e.dot(Rw);  // eq. (2)
  }
  found.a.template head<D>() = -force;
  found.a.template tail<turns<D>>() += moment_of<D>(force, at.p);  // eq. (3)
  found.b.template head<D>() = at.R.transpose() * force;
  found.a = adjoint_transpose_product<D>(X_a_inverse_, found.a);
  found.b = adjoint_transpose_product<D>(X_b_inverse_, found.b);
  return found;
}

template <int D>
typename ClosureConstraintIn<D>::GeometricStiffness ClosureConstraintIn<D>::geometric_stiffness(
    const FrameD& H_a, const FrameD& H_b, const Conditions& lambda) const {
  constexpr int t = turns<D>;
  const Placement at = place(H_a, H_b);
  const Rotation<D>& R = at.R;
  const auto lever = [](const PointD& r) { return lever_matrix<D>(r); };                         // τ → r × τ
  const auto moment = [](const PointD& r) { return (-lever_matrix<D>(r).transpose()).eval(); };  // f → r × f
  TwistMatrixD aa = TwistMatrixD::Zero(), ab = aa, ba = aa, bb = aa;
  PointD force = PointD::Zero();
  for (int i = 0; i < size(); ++i) {
    const Condition& c = conditions_[i];
    if (!c.turns) {
      force += lambda[i] * c.e;
      continue;
    }
    const double l = length_ * lambda[i];
    aa.template bottomRightCorner<t, t>() += l * moment(c.e) * lever(R * c.w);
    ab.template bottomRightCorner<t, t>() -= l * moment(c.e) * R * lever(c.w);
    bb.template bottomRightCorner<t, t>() += l * moment(c.w) * lever(R.transpose() * c.e);
    ba.template bottomRightCorner<t, t>() -= l * moment(c.w) * R.transpose() * lever(c.e);
  }
  aa.template bottomLeftCorner<t, D>() -= moment(force);
  aa.template bottomRightCorner<t, t>() += moment(force) * lever(at.p);
  ab.template bottomLeftCorner<t, D>() += moment(force) * R;
  bb.template topRightCorner<D, t>() += lever(R.transpose() * force);
  ba.template topRightCorner<D, t>() -= R.transpose() * lever(force);
  const TwistMatrixD Ad_a = adjoint<D>(X_a_inverse_), Ad_b = adjoint<D>(X_b_inverse_);
  return {Ad_a.transpose() * aa * Ad_a, Ad_a.transpose() * ab * Ad_b, Ad_b.transpose() * ba * Ad_a,
          Ad_b.transpose() * bb * Ad_b};
}

/// With the rates of (R, p) in the axes of A, where what is fixed in A turns backwards.
template <int D>
Conditions ClosureConstraintIn<D>::acceleration(const FrameD& H_a, const FrameD& H_b, const Rates& v,
                                                const Rates& v_dot) const {
  const Placement at = place(H_a, H_b);
  const TwistD a = adjoint_product<D>(X_a_inverse_, v.a), b = adjoint_product<D>(X_b_inverse_, v.b);
  const TwistD a_dot = adjoint_product<D>(X_a_inverse_, v_dot.a),
               b_dot = adjoint_product<D>(X_b_inverse_, v_dot.b);
  const auto cross = [](const TwistD& u, const PointD& r) -> PointD {
    return turn_cross<D>(u.template tail<turns<D>>(), r);
  };
  const PointD of_b = at.R * b.template head<D>();
  const PointD rate = of_b - a.template head<D>() - cross(a, at.p);  // p'
  const PointD second = at.R * (b_dot.template head<D>() + cross(b, b.template head<D>())) -
                        a_dot.template head<D>() - cross(a, of_b) - cross(a_dot, at.p) - cross(a, rate);
  Conditions found(size());
  for (int i = 0; i < size(); ++i) {
    const Condition& c = conditions_[i];
    if (!c.turns) {
      found[i] = c.e.dot(second);
      continue;
    }
    const PointD Rw = at.R * c.w, spun = at.R * cross(b, c.w);
    const PointD turned =
        at.R * (cross(b_dot, c.w) + cross(b, cross(b, c.w))) - cross(a, spun) - cross(a_dot, Rw);
    found[i] = length_ * c.e.dot(turned - cross(a, spun - cross(a, Rw)));
  }
  return found;
}

template <int D>
Twist<D> ClosureConstraintIn<D>::wrench_on_b(const FrameD& H_a, const FrameD& H_b,
                                             const Conditions& lambda) const {
  const Placement at = place(H_a, H_b);
  return -(adjoint<D>(FrameD::rotation(at.B.R)) * (on_b(at).transpose() * lambda));
}

namespace {

constexpr double rounding = 1e-12;  // of rotations that are multiplied along an arm

bool is_zero_or_one(double part) { return std::abs(part) < rounding || std::abs(part - 1) < rounding; }

/// Axes of the plane that stay where they are in X when X turns within the plane.
PlaneAxes axes_in(const Frame& X, const PlaneAxes& node) {
  const Vector3d normal = X.R.transpose() * node.normal();
  return PlaneAxes::with_normal(normal, std::abs(normal.x()) > 0.9 ? Vector3d::UnitY() : Vector3d::UnitX());
}

}  // namespace

/// The e of (1) are orthonormal, and so are the axes e × w of (2) where R = 1 but for a turn about w.
template <int D>
auto ClosureConstraintIn<D>::planar_part(const PlaneAxes& at_a, const PlaneAxes& at_b) const
    -> std::optional<PlanarPart>
  requires(D == 3)
{
  const PlaneAxes axes_a = axes_in(X_a_, at_a), axes_b = axes_in(X_b_, at_b);
  const Vector3d normal = axes_a.normal();
  Eigen::MatrixXd meet = Eigen::MatrixXd::Zero(size(), 2);
  Eigen::VectorXd lock = Eigen::VectorXd::Zero(size());
  const auto locks = std::ranges::count_if(conditions_, &Condition::turns);
  Vector3d e = Vector3d::Zero(), w;
  for (int i = 0; i < size(); ++i) {
    const Condition& c = conditions_[i];
    if (!c.turns) {
      meet.row(i) = axes_a.part(c.e).transpose();
    } else if (locks > 1) {
      lock[i] = normal.dot(c.e.cross(c.w));
      e += lock[i] * c.e;
    } else {  // universal: R turns about both
      const double off_a = std::abs(normal.dot(c.e)), off_b = std::abs(axes_b.normal().dot(c.w));
      const bool across = std::max(off_a, off_b) > 1 - rounding;
      if (!across && std::max(off_a, off_b) > rounding) return {};
      lock[i] = across ? 0 : 1;
      e = c.e, w = c.w;
    }
  }
  if (locks == 3) e = axes_a.E.col(0);  // R = 1
  if (locks > 1) w = normal.cross(e);
  const Eigen::Matrix2d met = meet.transpose() * meet;
  if (!is_zero_or_one(met.determinant()) || !is_zero_or_one(lock.squaredNorm())) return {};

  PlanarPart found{{node_a_, in_plane(X_a_, at_a, axes_a), node_b_, in_plane(X_b_, at_b, axes_b), length_},
                   {}};
  const auto add = [&](bool turns, const Vector2d& e_2, const Vector2d& w_2, const Eigen::VectorXd& of) {
    found.closure.conditions_.push_back({turns, e_2, w_2});
    found.combinations.conservativeResize(size(), found.closure.size());
    found.combinations.template rightCols<1>() = of;
  };
  const Vector2d none = Vector2d::Zero();
  if (met.determinant() > 0.5) {
    for (int k = 0; k < 2; ++k) add(false, Vector2d::Unit(k), none, meet.col(k));
  } else {
    const Vector2d along = met.col(met(0, 0) > met(1, 1) ? 0 : 1).normalized();
    if (!is_zero_or_one((meet * along).squaredNorm())) return {};
    add(false, along, none, meet * along);
  }
  if (lock.squaredNorm() > 0.5) add(true, axes_a.part(e), axes_b.part(w), lock);
  return found;
}

template class ClosureConstraintIn<2>;
template class ClosureConstraintIn<3>;

}  // namespace flexarm::joints
