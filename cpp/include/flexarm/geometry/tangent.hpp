/// @file
/// Tangent operators of the exponential of SE(2) and SE(3).
///
///     exp(h)⁻¹ d exp(h) = T_r(h) dh,          T_r(h) = Σ (−1)^k ad(h)^k / (k + 1)!        (1)
///     d exp(h) exp(h)⁻¹ = T_l(h) dh,          T_l(h) = T_r(−h)                            (2)
///     T_r⁻¹(h) = I + ½ ad + A(φ²) ad² + B(φ²) ad⁴,   φ = |ω|                    space     (3)
///     T_r⁻¹(h) = I + ½ ad + A₁(φ²) ad²                                          plane     (4)
///
/// (3) is exact, because ad (ad² + φ²)² = 0; with α = (φ/2) cot(φ/2) and β = (φ/2)²/sin²(φ/2), A = 2 (1 −
/// α)/φ² + (α − β)/(2 φ²) and B = (1 − α)/φ⁴ + (α − β)/(2 φ⁴). In the plane ad (ad² + φ²) = 0, hence (4) with
/// A₁ = (1 − α)/φ². Sources: [Bullo1995] for (3), [Sonneville2014] for the notation; docs/theory.md, section
/// "Frames".
#pragma once

#include <Eigen/LU>

#include "flexarm/geometry/frame.hpp"

namespace flexarm::geometry {

/// Coefficients A, B of (3) (A₁ and 0 in the plane) and their derivatives with respect to φ².
struct InverseTangentCoefficients {
  double A, B, dA, dB;
};
template <int D>
InverseTangentCoefficients inverse_tangent_coefficients(double phi_squared);
template <>
InverseTangentCoefficients inverse_tangent_coefficients<2>(double phi_squared);
template <>
InverseTangentCoefficients inverse_tangent_coefficients<3>(double phi_squared);

/// Equations (3), (4) and their mirror image T_l⁻¹(h) = T_r⁻¹(−h).
template <int D>
TwistMatrix<D> right_tangent_inverse(const Twist<D>& h);
template <int D>
TwistMatrix<D> left_tangent_inverse(const Twist<D>& h) {
  return right_tangent_inverse<D>(-h);
}

/// The products with (3), (4) that a two-node element needs, without forming matrices.
///
/// For a strain d and a stress σ it yields T_r⁻ᵀ(d) σ and T_l⁻ᵀ(d) σ; for two twists it yields the strain
/// rate T_r⁻¹(d) u₂ − T_l⁻¹(d) u₁. The even and odd parts are shared between the two ends.
template <int D, class Real = double>
class InverseTangentIn {
 public:
  using TwistD = Twist<D, Real>;

  explicit InverseTangentIn(const TwistD& d) : d_(d) {
    const Real x = d.template tail<turns<D>>().squaredNorm();
    if constexpr (D == 2) {
      A_ = series::inverse_v(x);
    } else if (series::below(x, series::tiny)) {
      set_tiny(x);
    } else {
      set_beyond(x);
    }
  }

  struct Pair {
    TwistD left, right;
  };

  /// (T_l⁻ᵀ σ, T_r⁻ᵀ σ)
  Pair transpose_times(const TwistD& sigma) const {
    const TwistD s1 = ad_transpose<D, Real>(d_, sigma);
    const TwistD s2 = ad_transpose<D, Real>(d_, s1);
    TwistD even = sigma + A_ * s2;
    if constexpr (D == 3) even += B_ * ad_transpose<D, Real>(d_, ad_transpose<D, Real>(d_, s2));
    return {even - 0.5 * s1, even + 0.5 * s1};
  }

  /// T_r⁻¹
  TwistMatrix<D, Real> right() const {
    TwistMatrix<D, Real> all;
    for (int k = 0; k < freedoms<D>; ++k) all.col(k) = strain_rate(TwistD::Zero(), TwistD::Unit(k));
    return all;
  }

  /// T_r⁻¹ u₂ − T_l⁻¹ u₁
  TwistD strain_rate(const TwistD& u1, const TwistD& u2) const {
    const TwistD difference = u2 - u1;
    const TwistD twice = ad_product<D, Real>(d_, ad_product<D, Real>(d_, difference));
    TwistD rate = difference + 0.5 * ad_product<D, Real>(d_, u1 + u2) + A_ * twice;
    if constexpr (D == 3) rate += B_ * ad_product<D, Real>(d_, ad_product<D, Real>(d_, twice));
    return rate;
  }

 private:
  void set_tiny(const Real& x) {
    A_ = 1.0 / 12 - x * x * (1.0 / 30240 + x * (2.0 / 1209600));
    B_ = -1.0 / 720 - x * (2.0 / 30240 + x * (3.0 / 1209600 + x * (4.0 / 47900160)));
  }
  void set_beyond(double x) {
    const auto k = inverse_tangent_coefficients<D>(x);
    A_ = k.A;
    B_ = k.B;
  }
  void set_beyond(Two x) {
    const auto first = inverse_tangent_coefficients<D>(x[0]), second = inverse_tangent_coefficients<D>(x[1]);
    A_ = Two(first.A, second.A);
    B_ = Two(first.B, second.B);
  }
  template <int N, class Processor>
  void set_beyond(const Pack<N, Processor>& x) {
    set_tiny(x);
    if (x.all_below(series::tiny)) return;
    for (int k = 0; k < N; ++k) {
      if (x[k] < series::tiny) continue;
      const auto own = inverse_tangent_coefficients<D>(x[k]);
      A_.set(k, own.A);
      B_.set(k, own.B);
    }
  }

  TwistD d_;
  Real A_, B_ = 0;
};

/// T_r(h) of (1), as the inverse of (3), (4); in space by its blocks [A B; 0 A].
template <int D, class Real = double>
TwistMatrix<D, Real> right_tangent(const As<Twist<D, Real>>& h) {
  TwistMatrix<D, Real> inverse;
  if constexpr (std::is_same_v<Real, double>) {
    inverse = right_tangent_inverse<D>(h);
  } else {
    inverse = InverseTangentIn<D, Real>(h).right();
  }
  if constexpr (D == 2) {
    return inverse.inverse();
  } else {
    const Rotation<3, Real> A = inverse.template topLeftCorner<3, 3>().inverse();
    TwistMatrix<D, Real> T = TwistMatrix<D, Real>::Zero();
    T.template topLeftCorner<3, 3>() = T.template bottomRightCorner<3, 3>() = A;
    T.template topRightCorner<3, 3>() = -(A * inverse.template topRightCorner<3, 3>() * A);
    return T;
  }
}

/// Derivative of the strain rate T_r⁻¹(d) u₂ − T_l⁻¹(d) u₁ with respect to d at fixed twists.
template <int D>
TwistMatrix<D> strain_rate_gradient(const Twist<D>& d, const Twist<D>& u1, const Twist<D>& u2);

/// Derivatives of T_l⁻ᵀ(d) σ and T_r⁻ᵀ(d) σ with respect to d at fixed σ: the geometric stiffness of an
/// element.
template <int D>
struct GeometricStiffnessIn {
  TwistMatrix<D> left, right;
};
template <int D>
GeometricStiffnessIn<D> geometric_stiffness(const Twist<D>& d, const Twist<D>& sigma);

}  // namespace flexarm::geometry
