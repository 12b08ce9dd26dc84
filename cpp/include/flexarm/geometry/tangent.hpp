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

/// Equations (3), (4) and their mirror image T_l⁻¹(h) = T_r⁻¹(−h).
template <int D>
TwistMatrix<D> right_tangent_inverse(const Twist<D>& h);
template <int D>
TwistMatrix<D> left_tangent_inverse(const Twist<D>& h) {
  return right_tangent_inverse<D>(-h);
}

/// T_r(h) of (1), as the inverse of (3).
template <int D>
TwistMatrix<D> right_tangent(const Twist<D>& h) {
  return right_tangent_inverse<D>(h).inverse();
}

/// The products with (3), (4) that a two-node element needs, without forming matrices.
///
/// For a strain d and a stress σ it yields T_r⁻ᵀ(d) σ and T_l⁻ᵀ(d) σ; for two twists it yields the strain
/// rate T_r⁻¹(d) u₂ − T_l⁻¹(d) u₁. The even and odd parts are shared between the two ends.
template <int D>
class InverseTangentIn {
 public:
  explicit InverseTangentIn(const Twist<D>& d) : d_(d) {
    const double x = rotation<D>(d).squaredNorm();
    if constexpr (D == 2) {
      A_ = series::inverse_v(x);
    } else if (x < series::tiny) {
      A_ = 1.0 / 12 - x * x * (1.0 / 30240 + x * (2.0 / 1209600));
      B_ = -1.0 / 720 - x * (2.0 / 30240 + x * (3.0 / 1209600 + x * (4.0 / 47900160)));
    } else {
      const auto k = inverse_tangent_coefficients<3>(x);
      A_ = k.A;
      B_ = k.B;
    }
  }

  struct Pair {
    Twist<D> left, right;
  };

  /// (T_l⁻ᵀ σ, T_r⁻ᵀ σ)
  Pair transpose_times(const Twist<D>& sigma) const {
    const Twist<D> s1 = ad_transpose<D>(d_, sigma);
    const Twist<D> s2 = ad_transpose<D>(d_, s1);
    Twist<D> even = sigma + A_ * s2;
    if constexpr (D == 3) even += B_ * ad_transpose<D>(d_, ad_transpose<D>(d_, s2));
    return {even - 0.5 * s1, even + 0.5 * s1};
  }

  /// T_r⁻¹ u₂ − T_l⁻¹ u₁
  Twist<D> strain_rate(const Twist<D>& u1, const Twist<D>& u2) const {
    const Twist<D> difference = u2 - u1;
    const Twist<D> twice = ad_product<D>(d_, ad_product<D>(d_, difference));
    Twist<D> rate = difference + 0.5 * ad_product<D>(d_, u1 + u2) + A_ * twice;
    if constexpr (D == 3) rate += B_ * ad_product<D>(d_, ad_product<D>(d_, twice));
    return rate;
  }

 private:
  Twist<D> d_;
  double A_, B_ = 0;
};

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
