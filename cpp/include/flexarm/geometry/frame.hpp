/// @file
/// The special Euclidean groups SE(2) and SE(3): frames, their exponential and their logarithm.
///
/// A frame H = (R, x) maps components in its own axes to its parent's: p_parent = R p + x. Twists, increments
/// and wrenches are in the axes of the frame they belong to.
///
///     exp(h) = (exp(ω~), V(ω) ρ),   V = I + b ω~ + c ω~²,   h = (ρ, ω)                               (1)
///     a = sin φ/φ,  b = (1 − cos φ)/φ²,  c = (φ − sin φ)/φ³,   φ = |ω|
///     V⁻¹ = I − ½ ω~ + A₁(φ²) ω~²,   A₁ = (1 − (φ/2) cot(φ/2))/φ²                                    (2)
///     Ad_H = [R  x~R; 0  R]                twist in H's axes -> twist in the parent's                 (3)
///     Ad_H u = (R σ − R τ × x, R τ)                                  u = (σ, τ)                       (4)
///     Ad_Hᵀ f = (Rᵀ n, Rᵀ (m − x × n))     wrench in the parent's axes -> wrench in H's  f = (n, m)   (5)
///
/// In the plane the rotation of rotations in (3)-(5) is 1. Small angles use the power series in φ². Sources:
/// [Bullo1995], [Sonneville2014]; docs/theory.md, section "Frames".
#pragma once

#include <cmath>

#include "flexarm/geometry/twist.hpp"
#include "flexarm/simd/pack_sine.hpp"
#include "flexarm/simd/two.hpp"

namespace flexarm::geometry {

using simd::lane;
using simd::Pack;
using simd::side_by_side;
using simd::sine_cosine;
using simd::SineCosine;
using simd::Two;

/// A rigid placement H = (R, x); with Real = Two that of two things.
template <int D, class Real = double>
struct FrameIn {
  using PointD = Point<D, Real>;
  using RotationD = Rotation<D, Real>;
  RotationD R = RotationD::Identity();
  PointD x = PointD::Zero();

  bool operator==(const FrameIn&) const = default;

  static FrameIn translation(const PointD& x) { return {RotationD::Identity(), x}; }
  static FrameIn rotation(const RotationD& R) { return {R, PointD::Zero()}; }

  FrameIn operator*(const FrameIn& other) const { return {R * other.R, x + R * other.x}; }
  PointD operator*(const PointD& point) const { return x + R * point; }
  FrameIn inverse() const { return {R.transpose(), -(R.transpose() * x)}; }
};

template <int D>
FrameIn<D, Two> side_by_side(const FrameIn<D>& first, const FrameIn<D>& second) {
  return {side_by_side(first.R, second.R), side_by_side(first.x, second.x)};
}
template <int D>
FrameIn<D> lane(const FrameIn<D, Two>& both, int which) {
  return {lane(both.R, which), lane(both.x, which)};
}

/// H1⁻¹ H2, the placement of frame 2 seen from frame 1.
template <int D, class Real>
FrameIn<D, Real> relative(const FrameIn<D, Real>& H1, const FrameIn<D, Real>& H2) {
  return {H1.R.transpose() * H2.R, H1.R.transpose() * (H2.x - H1.x)};
}

/// Equation (3).
template <int D, class Real>
TwistMatrix<D, Real> adjoint(const FrameIn<D, Real>& H) {
  TwistMatrix<D, Real> Ad = TwistMatrix<D, Real>::Zero();
  Ad.template topLeftCorner<D, D>() = H.R;
  if constexpr (D == 2) {
    Ad.template topRightCorner<2, 1>() = lever_matrix<2, Real>(H.x);
    Ad(2, 2) = 1;
  } else {
    Ad.template topRightCorner<3, 3>() = skew<Real>(H.x) * H.R;
    Ad.template bottomRightCorner<3, 3>() = H.R;
  }
  return Ad;
}

/// Equation (4), without the matrix.
template <int D, class Real = double>
Twist<D, Real> adjoint_product(const FrameIn<D, Real>& H, const As<Twist<D, Real>>& u) {
  Turn<D, Real> turn = u.template tail<turns<D>>();
  if constexpr (D == 3) turn = H.R * turn;
  Twist<D, Real> out;
  out.template head<D>() = H.R * u.template head<D>() - turn_cross<D, Real>(turn, H.x);
  out.template tail<turns<D>>() = turn;
  return out;
}

/// Equation (5), without the matrix.
template <int D, class Real = double>
Twist<D, Real> adjoint_transpose_product(const FrameIn<D, Real>& H, const As<Twist<D, Real>>& f) {
  const Point<D, Real> force = f.template head<D>();
  Turn<D, Real> moment = f.template tail<turns<D>>() - moment_of<D, Real>(H.x, force);
  if constexpr (D == 3) moment = H.R.transpose() * moment;
  Twist<D, Real> out;
  out.template head<D>() = H.R.transpose() * force;
  out.template tail<turns<D>>() = moment;
  return out;
}

namespace series {

// Below the limits the series are exact to the last digit with the terms kept. Nodes turn by less than the
// first in a step, the ends of an element against each other hardly ever by more than the second.
constexpr double least = 1e-5, slight = 1e-4, tiny = 1e-3, small = 0.04;

/// a, b, c of (1) as functions of φ².
template <class Real = double>
struct Exponential {
  Real a, b, c;
};
Exponential<> exponential_beyond(double phi_squared);  // closed forms

template <class Real>
Exponential<Real> exponential_of_tiny(const Real& x) {
  return {1 + x * (-1.0 / 6 + x * (1.0 / 120 + x * (-1.0 / 5040 + x * (1.0 / 362880)))),
          0.5 + x * (-1.0 / 24 + x * (1.0 / 720 + x * (-1.0 / 40320))),
          1.0 / 6 + x * (-1.0 / 120 + x * (1.0 / 5040 + x * (-1.0 / 362880)))};
}

template <class Real>
Exponential<Real> exponential_of_least(const Real& x) {
  return {1 + x * (-1.0 / 6 + x * (1.0 / 120)), 0.5 + x * (-1.0 / 24 + x * (1.0 / 720)),
          1.0 / 6 + x * (-1.0 / 120 + x * (1.0 / 5040))};
}

/// The power series, by Horner's scheme.
template <class Real>
Exponential<Real> exponential_of_small(const Real& x) {
  return {
      1 + x * (-1.0 / 6 + x * (1.0 / 120 + x * (-1.0 / 5040 + x * (1.0 / 362880 - x * (1.0 / 39916800))))),
      0.5 + x * (-1.0 / 24 +
                 x * (1.0 / 720 + x * (-1.0 / 40320 + x * (1.0 / 3628800 - x * (1.0 / 479001600))))),
      1.0 / 6 + x * (-1.0 / 120 +
                     x * (1.0 / 5040 + x * (-1.0 / 362880 + x * (1.0 / 39916800 - x * (1.0 / 6227020800)))))};
}

/// The closed forms. @param sine_cosine finds both of φ/2 together
template <class Real, class SineCosineOf>
Exponential<Real> exponential_by_sine(const Real& x, const Real& phi, SineCosineOf sine_cosine) {
  const auto [half_sine, half_cosine] = sine_cosine(Real(0.5 * phi));
  const Real sine = 2 * half_sine * half_cosine;
  return {sine / phi, 2 * half_sine * half_sine / x, (phi - sine) / (x * phi)};
}

inline Exponential<> exponential(double x) {
  if (x < least) return exponential_of_least(x);
  return x < tiny ? exponential_of_tiny(x) : exponential_beyond(x);
}

inline Exponential<Two> exponential(Two x) {
  if (x.both_below(least)) return exponential_of_least(x);
  if (x.both_below(tiny)) return exponential_of_tiny(x);
  const Exponential<> first = exponential(x[0]), second = exponential(x[1]);
  return {{first.a, second.a}, {first.b, second.b}, {first.c, second.c}};
}

/// Of lanes none may depend on the others: the longer series serves all that are small.
template <int N, class Processor>
Exponential<Pack<N, Processor>> exponential(const Pack<N, Processor>& x) {
  using Real = Pack<N, Processor>;
  const Exponential<Real> near = exponential_of_small(x);
  if (x.all_below(small)) return near;
  const Real within = x.ones_below(small), beyond = 1 - within;
  const auto closed = exponential_by_sine(x, x.root(), [](const Real& half) { return sine_cosine(half); });
  return {near.a.where(within) + closed.a.where(beyond), near.b.where(within) + closed.b.where(beyond),
          near.c.where(within) + closed.c.where(beyond)};
}

/// A₁ of (2).
double inverse_v_beyond(double phi_squared);

template <class Real>
Real inverse_v_of_tiny(const Real& x) {
  return 1.0 / 12 + x * (1.0 / 720 + x * (1.0 / 30240 + x * (1.0 / 1209600)));
}

inline double inverse_v(double x) {
  if (x < slight) return 1.0 / 12 + x * (1.0 / 720 + x * (1.0 / 30240));
  return x < tiny ? inverse_v_of_tiny(x) : inverse_v_beyond(x);
}

inline Two inverse_v(Two x) {
  return x.both_below(tiny) ? inverse_v_of_tiny(x) : Two(inverse_v(x[0]), inverse_v(x[1]));
}

template <int N, class Processor>
Pack<N, Processor> inverse_v(const Pack<N, Processor>& x) {
  Pack<N, Processor> all = inverse_v_of_tiny(x);
  if (x.all_below(tiny)) return all;
  for (int k = 0; k < N; ++k) {
    if (!(x[k] < tiny)) all.set(k, inverse_v_beyond(x[k]));
  }
  return all;
}

inline bool below(double x, double limit) { return x < limit; }
inline bool below(Two x, double limit) { return x.both_below(limit); }
template <int N, class Processor>
bool below(const Pack<N, Processor>&, double) {
  return false;
}

/// Rotation vector from the axial vector s = sin φ n of a rotation by less than 0.1: φ/sin φ as a function of
/// s².
template <class Real>
Real arcsine_ratio(const Real& y) {
  if (below(y, slight)) return 1 + y * (1.0 / 6 + y * (3.0 / 40 + y * (5.0 / 112)));
  return 1 + y * (1.0 / 6 + y * (3.0 / 40 + y * (5.0 / 112 +
                                                 y * (35.0 / 1152 + y * (63.0 / 2816 + y * 231.0 / 13312)))));
}

}  // namespace series

/// Rotation matrix of a rotation vector, and back (angle in [0, π]).
Matrix3d exp3(const Vector3d& omega);
Vector3d log3_beyond(const Matrix3d& R);  // any angle
void log3_beyond(const double* R, double* omega);

/// sin φ n.
template <class Real>
Point<3, Real> axial(const Rotation<3, Real>& R) {
  return {0.5 * (R(2, 1) - R(1, 2)), 0.5 * (R(0, 2) - R(2, 0)), 0.5 * (R(1, 0) - R(0, 1))};
}

inline Vector3d log3(const Matrix3d& R) {
  const Vector3d s = axial<double>(R);
  const double s_squared = s.squaredNorm();
  if (s_squared < 0.01 && R.trace() > 1) return series::arcsine_ratio(s_squared) * s;
  return log3_beyond(R);
}

inline Point<3, Two> log3(const Rotation<3, Two>& R) {
  const Point<3, Two> s = axial<Two>(R);
  const Two s_squared = s.squaredNorm();
  if (s_squared.both_below(0.01) && R.trace().both_above(1)) return series::arcsine_ratio(s_squared) * s;
  return side_by_side(log3(lane(R, 0)), log3(lane(R, 1)));
}

template <int N, class Processor>
Point<3, Pack<N, Processor>> log3(const Rotation<3, Pack<N, Processor>>& R) {
  using Real = Pack<N, Processor>;
  const Point<3, Real> s = axial<Real>(R);
  const Real s_squared = s.squaredNorm(), short_of_trace = 1 - R.trace();
  Point<3, Real> all = series::arcsine_ratio(s_squared) * s;
  if (s_squared.all_below(0.01) && short_of_trace.all_below(0)) return all;
  for (int k = 0; k < N; ++k) {
    if (s_squared[k] < 0.01 && short_of_trace[k] < 0) continue;
    double own[9], omega[3];
    for (int i = 0; i < 9; ++i) own[i] = R.data()[i][k];
    log3_beyond(own, omega);
    for (int i = 0; i < 3; ++i) all[i].set(k, omega[i]);
  }
  return all;
}

/// Angle of a rotation in the plane, in (−π, π].
inline double log1(const Matrix2d& R) {
  const double s = R(1, 0), s_squared = s * s;
  if (s_squared < 0.01 && R(0, 0) > 0) return series::arcsine_ratio(s_squared) * s;
  return std::atan2(s, R(0, 0));
}

inline Two log1(const Rotation<2, Two>& R) {
  const Two s = R(1, 0), s_squared = s * s;
  if (s_squared.both_below(0.01) && R(0, 0).both_above(0)) return series::arcsine_ratio(s_squared) * s;
  return {log1(lane(R, 0)), log1(lane(R, 1))};
}

template <int N, class Processor>
Pack<N, Processor> log1(const Rotation<2, Pack<N, Processor>>& R) {
  using Real = Pack<N, Processor>;
  const Real s = R(1, 0), s_squared = s * s;
  Real all = series::arcsine_ratio(s_squared) * s;
  if (s_squared.all_below(0.01) && (-R(0, 0)).all_below(0)) return all;
  for (int k = 0; k < N; ++k) {
    if (!(s_squared[k] < 0.01 && R(0, 0)[k] > 0)) all.set(k, std::atan2(s[k], R(0, 0)[k]));
  }
  return all;
}

/// Equation (1). Exact for every argument.
template <int D, class Real = double>
FrameIn<D, Real> exponential(const As<Twist<D, Real>>& h) {
  FrameIn<D, Real> H;
  if constexpr (D == 2) {
    const Real phi = h[2], x = phi * phi;
    const auto [a, b, c] = series::exponential(x);
    const Real sine = a * phi, cosine = 1 - b * x, turned = b * phi;
    H.R << cosine, -sine, sine, cosine;
    H.x << a * h[0] - turned * h[1], a * h[1] + turned * h[0];  // I + c φ² J² = 1 − c φ² = a
  } else {
    using Vector = Point<3, Real>;
    const Vector rho = h.template head<3>(), omega = h.template tail<3>();
    const Real x = omega.squaredNorm();
    const auto [a, b, c] = series::exponential(x);
    const Vector once = omega.cross(rho), s = a * omega, v = b * omega;
    const Real cosine = 1 - b * x;  // a ω~ + b ω ωᵀ + (1 − b φ²) I, written out
    const Real xy = v[0] * omega[1], xz = v[0] * omega[2], yz = v[1] * omega[2];
    H.R << cosine + v[0] * omega[0], xy - s[2], xz + s[1],  //
        xy + s[2], cosine + v[1] * omega[1], yz - s[0],     //
        xz - s[1], yz + s[0], cosine + v[2] * omega[2];
    H.x = rho + omega.cross(Vector(b * rho + c * once));
  }
  return H;
}

/// Inverse of (1): rotation angle in [0, π], in the plane in (−π, π].
template <int D, class Real>
Twist<D, Real> logarithm(const FrameIn<D, Real>& H) {
  if constexpr (D == 2) {
    const Real phi = log1(H.R), half = 0.5 * phi, x = phi * phi;
    const Real alpha = 1 - series::inverse_v(x) * x;  // eq. (2) with J² = −I
    return {alpha * H.x[0] + half * H.x[1], alpha * H.x[1] - half * H.x[0], phi};
  } else {
    const Point<3, Real> omega = log3(H.R);
    const Point<3, Real> once = omega.cross(H.x);
    Twist<3, Real> h;
    h.template head<3>() =
        H.x - 0.5 * once + series::inverse_v(Real(omega.squaredNorm())) * omega.cross(once);  // eq. (2)
    h.template tail<3>() = omega;
    return h;
  }
}

}  // namespace flexarm::geometry
