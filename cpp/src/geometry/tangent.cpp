#include "flexarm/geometry/tangent.hpp"

#include <cmath>

namespace flexarm::geometry {
namespace {

// (φ/2) cot(φ/2) = 1 − Σ c_k φ^2k.
constexpr double c1 = 1.0 / 12, c2 = 1.0 / 720, c3 = 1.0 / 30240, c4 = 1.0 / 1209600, c5 = 1.0 / 47900160,
                 c6 = 691.0 / 1307674368000.0, c7 = 1.0 / 74724249600.0;
constexpr double series_limit = 0.25;

/// α, β of the file's head and their derivatives with respect to x = φ².
struct HalfAngle {
  double alpha, beta, d_alpha, d_beta;

  explicit HalfAngle(double x) {
    const double half = 0.5 * std::sqrt(x);
    const double sine = std::sin(half);
    alpha = half * std::cos(half) / sine;
    beta = half * half / (sine * sine);
    d_alpha = (alpha - beta) / (2 * x);
    d_beta = beta * (1 - alpha) / x;
  }
};

}  // namespace

template <>
InverseTangentCoefficients inverse_tangent_coefficients<2>(double x) {
  if (x < series_limit) {
    return {c1 + x * (c2 + x * (c3 + x * (c4 + x * (c5 + x * (c6 + x * c7))))), 0,
            c2 + x * (2 * c3 + x * (3 * c4 + x * (4 * c5 + x * (5 * c6 + x * 6 * c7)))), 0};
  }
  const HalfAngle half(x);
  return {(1 - half.alpha) / x, 0, -half.d_alpha / x - (1 - half.alpha) / (x * x), 0};
}

template <>
InverseTangentCoefficients inverse_tangent_coefficients<3>(double x) {
  if (x < series_limit) {
    // From y coth(y) with y³ = −2 φ² y² − φ⁴ y, term by term.
    return {c1 - x * x * (c3 + x * (2 * c4 + x * (3 * c5 + x * (4 * c6 + x * 5 * c7)))),
            -c2 - x * (2 * c3 + x * (3 * c4 + x * (4 * c5 + x * (5 * c6 + x * 6 * c7)))),
            -x * (2 * c3 + x * (6 * c4 + x * (12 * c5 + x * (20 * c6 + x * 30 * c7)))),
            -(2 * c3 + x * (6 * c4 + x * (12 * c5 + x * (20 * c6 + x * 30 * c7))))};
  }
  const HalfAngle half(x);
  const double u = 1 - half.alpha;
  const double w = 0.5 * (half.alpha - half.beta);
  const double dw = 0.5 * (half.d_alpha - half.d_beta);
  return {(2 * u + w) / x, (u + w) / (x * x), (-2 * half.d_alpha + dw) / x - (2 * u + w) / (x * x),
          (-half.d_alpha + dw) / (x * x) - 2 * (u + w) / (x * x * x)};
}

template <int D>
TwistMatrix<D> right_tangent_inverse(const Twist<D>& h) {
  if constexpr (D == 2) {  // eq. (4), written out
    const double omega = h[2], A = series::inverse_v(omega * omega), on_diagonal = 1 - A * omega * omega;
    return (Matrix3d() << on_diagonal, -0.5 * omega, 0.5 * h[1] + A * omega * h[0],  //
            0.5 * omega, on_diagonal, -0.5 * h[0] + A * omega * h[1],                //
            0, 0, 1)
        .finished();
  } else {
    const auto k = inverse_tangent_coefficients<D>(rotation<D>(h).squaredNorm());
    const TwistMatrix<D> a = ad<D>(h);
    const TwistMatrix<D> a2 = a * a;
    return TwistMatrix<D>::Identity() + 0.5 * a + k.A * a2 + k.B * a2 * a2;  // eq. (3)
  }
}

template <int D>
TwistMatrix<D> strain_rate_gradient(const Twist<D>& d, const Twist<D>& u1, const Twist<D>& u2) {
  const auto k = inverse_tangent_coefficients<D>(rotation<D>(d).squaredNorm());
  const TwistMatrix<D> N = ad<D>(d);
  const Twist<D> difference = u2 - u1;
  const Twist<D> s1 = N * difference, s2 = N * s1;
  // Product rule on N, N², N⁴ with d(ad(d) s) = −ad(s) dd, then on A(φ²) and B(φ²).
  const TwistMatrix<D> twice = ad<D>(s1) + N * ad<D>(difference);
  TwistMatrix<D> G = -0.5 * ad<D>(u1 + u2) - k.A * twice;
  Twist<D> growth = k.dA * s2;
  if constexpr (D == 3) {
    const Twist<D> s3 = N * s2, s4 = N * s3;
    G -= k.B * (ad<D>(s3) + N * (ad<D>(s2) + N * twice));
    growth += k.dB * s4;
  }
  G.template rightCols<turns<D>>() += 2 * growth * rotation<D>(d).transpose();
  return G;
}

template <int D>
GeometricStiffnessIn<D> geometric_stiffness(const Twist<D>& d, const Twist<D>& sigma) {
  const auto k = inverse_tangent_coefficients<D>(rotation<D>(d).squaredNorm());
  const TwistMatrix<D> N = ad<D>(d).transpose();
  const Twist<D> s1 = N * sigma, s2 = N * s1;
  const TwistMatrix<D> C0 = ad_transpose_by_twist<D>(sigma), C1 = ad_transpose_by_twist<D>(s1);
  // Product rule on N², N⁴, then on A(φ²) and B(φ²).
  TwistMatrix<D> even = k.A * (C1 + N * C0);
  Twist<D> growth = k.dA * s2;
  if constexpr (D == 3) {
    const Twist<D> s3 = N * s2, s4 = N * s3;
    const TwistMatrix<D> C2 = ad_transpose_by_twist<D>(s2), C3 = ad_transpose_by_twist<D>(s3);
    even += k.B * (C3 + N * (C2 + N * (C1 + N * C0)));
    growth += k.dB * s4;
  }
  even.template rightCols<turns<D>>() += 2 * growth * rotation<D>(d).transpose();
  return {even - 0.5 * C0, even + 0.5 * C0};
}

template TwistMatrix<2> right_tangent_inverse<2>(const Twist<2>&);
template TwistMatrix<3> right_tangent_inverse<3>(const Twist<3>&);
template TwistMatrix<2> strain_rate_gradient<2>(const Twist<2>&, const Twist<2>&, const Twist<2>&);
template TwistMatrix<3> strain_rate_gradient<3>(const Twist<3>&, const Twist<3>&, const Twist<3>&);
template GeometricStiffnessIn<2> geometric_stiffness<2>(const Twist<2>&, const Twist<2>&);
template GeometricStiffnessIn<3> geometric_stiffness<3>(const Twist<3>&, const Twist<3>&);

}  // namespace flexarm::geometry
