/// @file
/// Twists and wrenches of the plane (D = 2) and of space (D = 3), and the products of their Lie algebras.
///
/// A twist h = (ρ, ω) has D entries of translation and D (D − 1)/2 of rotation, a wrench f = (n, m) as many
/// of force and moment. In the plane ω and m are the components along its normal; with ω~ the matrix of a → ω
/// × a and ρ~ that of τ → ρ × τ,
///
///     ad(h) = [ω~  ρ~; 0  ω~]            plane: [ω J  −J ρ; 0  0],  J = [0 −1; 1 0]                   (1)
///     ad(h) u  = (ω × σ + ρ × τ, ω × τ)                             u = (σ, τ)                        (2)
///     ad(h)ᵀ f = (n × ω, n × ρ + m × ω)                                                              (3)
///
/// Every operation of the plane is that of space, restricted to a plane. Sources: [Bullo1995],
/// [Sonneville2014]; docs/theory.md, section "Frames".
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <type_traits>

namespace flexarm::geometry {

template <int D>
inline constexpr int turns = D * (D - 1) / 2;  ///< components of a rotation

template <int D>
inline constexpr int freedoms = D + turns<D>;  ///< of a rigid body: 3 in the plane, 6 in space

template <int D, class Real = double>
using Point = Eigen::Matrix<Real, D, 1>;
template <int D, class Real = double>
using Turn = Eigen::Matrix<Real, turns<D>, 1>;
template <int D, class Real = double>
using Rotation = Eigen::Matrix<Real, D, D>;
template <int D, class Real = double>
using Twist = Eigen::Matrix<Real, freedoms<D>, 1>;
template <int D, class Real = double>
using TwistMatrix = Eigen::Matrix<Real, freedoms<D>, freedoms<D>>;

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Vector6d = Twist<3>;
using Matrix6d = TwistMatrix<3>;

/// An argument that does not decide of which numbers it is made: expressions become what is asked for.
template <class T>
using As = std::type_identity_t<T>;

/// Cross-product matrix: skew(a) b = a × b.
template <class Real = double>
Rotation<3, Real> skew(const As<Point<3, Real>>& a) {
  Rotation<3, Real> S;
  S << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return S;
}

template <int D>
Eigen::Block<const Twist<D>, D, 1> translation(const Twist<D>& h) {
  return h.template head<D>();
}

template <int D>
Eigen::Block<const Twist<D>, turns<D>, 1> rotation(const Twist<D>& h) {
  return h.template tail<turns<D>>();
}

/// ω × p of a rotation and an arrow: the velocity of a point.
template <int D, class Real = double>
Point<D, Real> turn_cross(const As<Turn<D, Real>>& omega, const As<Point<D, Real>>& p) {
  if constexpr (D == 2) {
    return {-omega[0] * p[1], omega[0] * p[0]};
  } else {
    return omega.cross(p);
  }
}

/// r × f of two arrows: the moment of a force.
template <int D, class Real = double>
Turn<D, Real> moment_of(const As<Point<D, Real>>& r, const As<Point<D, Real>>& f) {
  if constexpr (D == 2) {
    return Turn<2, Real>(r[0] * f[1] - r[1] * f[0]);
  } else {
    return r.cross(f);
  }
}

/// ω~.
template <int D>
Rotation<D> turn_matrix(const Turn<D>& omega) {
  if constexpr (D == 2) {
    return (Matrix2d() << 0, -omega[0], omega[0], 0).finished();
  } else {
    return skew(omega);
  }
}

/// ρ~: τ → ρ × τ.
template <int D, class Real = double>
Eigen::Matrix<Real, D, turns<D>> lever_matrix(const As<Point<D, Real>>& rho) {
  if constexpr (D == 2) {
    return {rho[1], -rho[0]};
  } else {
    return skew<Real>(rho);
  }
}

/// Equation (1).
template <int D>
TwistMatrix<D> ad(const Twist<D>& h) {
  TwistMatrix<D> a = TwistMatrix<D>::Zero();
  a.template topLeftCorner<D, D>() = turn_matrix<D>(rotation<D>(h));
  a.template topRightCorner<D, turns<D>>() = lever_matrix<D>(translation<D>(h));
  if constexpr (D == 3) a.template bottomRightCorner<3, 3>() = turn_matrix<D>(rotation<D>(h));
  return a;
}

/// Equation (2).
template <int D, class Real = double>
Twist<D, Real> ad_product(const As<Twist<D, Real>>& h, const As<Twist<D, Real>>& u) {
  if constexpr (D == 2) {
    return {-h[2] * u[1] + h[1] * u[2], h[2] * u[0] - h[0] * u[2], 0};
  } else {
    const Point<3, Real> rho = h.template head<3>(), omega = h.template tail<3>();
    const Point<3, Real> s = u.template head<3>(), t = u.template tail<3>();
    Twist<3, Real> out;
    out.template head<3>() = omega.cross(s) + rho.cross(t);
    out.template tail<3>() = omega.cross(t);
    return out;
  }
}

/// Equation (3).
template <int D, class Real = double>
Twist<D, Real> ad_transpose(const As<Twist<D, Real>>& h, const As<Twist<D, Real>>& f) {
  if constexpr (D == 2) {
    return {f[1] * h[2], -f[0] * h[2], f[0] * h[1] - f[1] * h[0]};
  } else {
    const Point<3, Real> rho = h.template head<3>(), omega = h.template tail<3>();
    const Point<3, Real> n = f.template head<3>(), m = f.template tail<3>();
    Twist<3, Real> out;
    out.template head<3>() = n.cross(omega);
    out.template tail<3>() = n.cross(rho) + m.cross(omega);
    return out;
  }
}

/// Matrix C(f) with ad(h)ᵀ f = C(f) h, for derivatives with respect to h.
template <int D>
TwistMatrix<D> ad_transpose_by_twist(const Twist<D>& f) {
  if constexpr (D == 2) {
    return (Matrix3d() << 0, 0, f[1], 0, 0, -f[0], -f[1], f[0], 0).finished();
  } else {
    const Matrix3d n = skew(f.template head<3>());
    Matrix6d C;
    C << Matrix3d::Zero(), n, n, skew(f.template tail<3>());
    return C;
  }
}

}  // namespace flexarm::geometry
