#include "flexarm/geometry/se3.hpp"

#include <Eigen/LU>
#include <cmath>

namespace flexarm::geometry {
namespace {

// Below this φ² the series are exact to the last digit with the terms kept.
constexpr double series_limit = 0.04;

/// sin φ/φ, (1 − cos φ)/φ², (φ − sin φ)/φ³ as functions of φ².
struct ExpCoefficients {
  double a, b, c;
};

ExpCoefficients exp_coefficients(double phi_squared) {
  const double x = phi_squared;
  if (x < series_limit) {  // the power series, by Horner's scheme
    return {
        1 + x * (-1.0 / 6 + x * (1.0 / 120 + x * (-1.0 / 5040 + x * (1.0 / 362880 - x * (1.0 / 39916800))))),
        0.5 + x * (-1.0 / 24 +
                   x * (1.0 / 720 + x * (-1.0 / 40320 + x * (1.0 / 3628800 - x * (1.0 / 479001600))))),
        1.0 / 6 + x * (-1.0 / 120 + x * (1.0 / 5040 + x * (-1.0 / 362880 +
                                                           x * (1.0 / 39916800 - x * (1.0 / 6227020800)))))};
  }
  const double phi = std::sqrt(x);
  const double half_sine = std::sin(0.5 * phi);
  const double sine = std::sin(phi);
  return {sine / phi, 2 * half_sine * half_sine / x, (phi - sine) / (x * phi)};
}

/// (1 − (φ/2) cot(φ/2))/φ², the second coefficient of V⁻¹.
double inverse_v_coefficient(double phi_squared) {
  const double x = phi_squared;
  if (x < series_limit) {
    return 1.0 / 12 + x * (1.0 / 720 + x * (1.0 / 30240 + x * (1.0 / 1209600 + x * (1.0 / 47900160))));
  }
  const double half = 0.5 * std::sqrt(x);
  return (1 - half * std::cos(half) / std::sin(half)) / x;
}

/// asin(s)/s as a function of s², for s² below 0.01.
double arcsine_ratio(double s_squared) {
  const double y = s_squared;
  return 1 + y * (1.0 / 6 + y * (3.0 / 40 + y * (5.0 / 112 +
                                                 y * (35.0 / 1152 + y * (63.0 / 2816 + y * 231.0 / 13312)))));
}

}  // namespace

Matrix3d skew(const Vector3d& a) {
  Matrix3d S;
  S << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return S;
}

Frame relative(const Frame& H1, const Frame& H2) {
  return {H1.R.transpose() * H2.R, H1.R.transpose() * (H2.x - H1.x)};
}

Matrix3d exp3(const Vector3d& omega) {
  const ExpCoefficients k = exp_coefficients(omega.squaredNorm());
  Matrix3d R = k.b * omega * omega.transpose() + k.a * skew(omega);
  R.diagonal().array() += 1 - k.b * omega.squaredNorm();
  return R;
}

Frame exp6(const Vector6d& h) {
  const Vector3d rho = h.head<3>();
  const Vector3d omega = h.tail<3>();
  const double phi_squared = omega.squaredNorm();
  const ExpCoefficients k = exp_coefficients(phi_squared);
  Frame H;
  H.R = k.b * omega * omega.transpose() + k.a * skew(omega);
  H.R.diagonal().array() += 1 - k.b * phi_squared;
  const Vector3d once = omega.cross(rho);
  H.x = rho + k.b * once + k.c * omega.cross(once);  // eq. (1)
  return H;
}

Vector3d log3(const Matrix3d& R) {
  const Vector3d axial{0.5 * (R(2, 1) - R(1, 2)), 0.5 * (R(0, 2) - R(2, 0)), 0.5 * (R(1, 0) - R(0, 1))};
  const double s_squared = axial.squaredNorm();
  if (s_squared < 0.01 && R.trace() > 1) {
    return arcsine_ratio(s_squared) * axial;
  }
  Eigen::Quaterniond q(R);
  q.normalize();
  if (q.w() < 0) {
    q.coeffs() *= -1;
  }
  const double n = q.vec().norm();
  return q.vec() * (2 * std::atan2(n, q.w()) / n);
}

Vector6d log6(const Frame& H) {
  const Vector3d omega = log3(H.R);
  const Vector3d once = omega.cross(H.x);
  Vector6d h;
  h.head<3>() = H.x - 0.5 * once + inverse_v_coefficient(omega.squaredNorm()) * omega.cross(once);
  h.tail<3>() = omega;
  return h;
}

Matrix6d adjoint(const Frame& H) {
  Matrix6d Ad;
  Ad << H.R, skew(H.x) * H.R, Matrix3d::Zero(), H.R;  // eq. (2)
  return Ad;
}

Matrix6d ad(const Vector6d& h) {
  const Matrix3d omega = skew(h.tail<3>());
  Matrix6d a;
  a << omega, skew(h.head<3>()), Matrix3d::Zero(), omega;  // eq. (3)
  return a;
}

Vector6d ad_transpose(const Vector6d& h, const Vector6d& f) {
  const Vector3d rho = h.head<3>(), omega = h.tail<3>(), n = f.head<3>(), m = f.tail<3>();
  Vector6d out;
  out << n.cross(omega), n.cross(rho) + m.cross(omega);
  return out;
}

Vector6d ad_product(const Vector6d& h, const Vector6d& u) {
  const Vector3d rho = h.head<3>(), omega = h.tail<3>(), s = u.head<3>(), t = u.tail<3>();
  Vector6d out;
  out << omega.cross(s) + rho.cross(t), omega.cross(t);
  return out;
}

Matrix6d ad_transpose_by_twist(const Vector6d& f) {
  const Matrix3d n = skew(f.head<3>());
  Matrix6d C;
  C << Matrix3d::Zero(), n, n, skew(f.tail<3>());
  return C;
}

InverseTangentCoefficients inverse_tangent_coefficients(double phi_squared) {
  const double x = phi_squared;
  if (x < 0.25) {
    // From y coth(y) with y³ = −2 φ² y² − φ⁴ y, term by term.
    constexpr double c3 = 1.0 / 30240, c4 = 1.0 / 1209600, c5 = 1.0 / 47900160, c6 = 691.0 / 1307674368000.0,
                     c7 = 1.0 / 74724249600.0;
    return {1.0 / 12 - x * x * (c3 + x * (2 * c4 + x * (3 * c5 + x * (4 * c6 + x * 5 * c7)))),
            -1.0 / 720 - x * (2 * c3 + x * (3 * c4 + x * (4 * c5 + x * (5 * c6 + x * 6 * c7)))),
            -x * (2 * c3 + x * (6 * c4 + x * (12 * c5 + x * (20 * c6 + x * 30 * c7)))),
            -(2 * c3 + x * (6 * c4 + x * (12 * c5 + x * (20 * c6 + x * 30 * c7))))};
  }
  const double half = 0.5 * std::sqrt(x);
  const double sine = std::sin(half);
  const double alpha = half * std::cos(half) / sine;
  const double beta = half * half / (sine * sine);
  const double d_alpha = (alpha - beta) / (2 * x);
  const double d_beta = beta * (1 - alpha) / x;
  const double u = 1 - alpha;
  const double w = 0.5 * (alpha - beta);
  const double dw = 0.5 * (d_alpha - d_beta);
  return {(2 * u + w) / x, (u + w) / (x * x), (-2 * d_alpha + dw) / x - (2 * u + w) / (x * x),
          (-d_alpha + dw) / (x * x) - 2 * (u + w) / (x * x * x)};
}

Matrix6d right_tangent_inverse(const Vector6d& h) {
  const InverseTangentCoefficients k = inverse_tangent_coefficients(h.tail<3>().squaredNorm());
  const Matrix6d a = ad(h);
  const Matrix6d a2 = a * a;
  return Matrix6d::Identity() + 0.5 * a + k.A * a2 + k.B * a2 * a2;  // eq. (6)
}

Matrix6d left_tangent_inverse(const Vector6d& h) { return right_tangent_inverse(-h); }

Matrix6d right_tangent(const Vector6d& h) { return right_tangent_inverse(h).inverse(); }

InverseTangent::InverseTangent(const Vector6d& d) : d_(d) {
  const InverseTangentCoefficients k = inverse_tangent_coefficients(d.tail<3>().squaredNorm());
  A_ = k.A;
  B_ = k.B;
}

InverseTangent::Pair InverseTangent::transpose_times(const Vector6d& sigma) const {
  const Vector6d s1 = ad_transpose(d_, sigma);
  const Vector6d s2 = ad_transpose(d_, s1);
  const Vector6d s4 = ad_transpose(d_, ad_transpose(d_, s2));
  const Vector6d even = sigma + A_ * s2 + B_ * s4;
  return {even - 0.5 * s1, even + 0.5 * s1};
}

Vector6d InverseTangent::strain_rate(const Vector6d& u1, const Vector6d& u2) const {
  const Vector6d difference = u2 - u1;
  const Vector6d twice = ad_product(d_, ad_product(d_, difference));
  const Vector6d four = ad_product(d_, ad_product(d_, twice));
  return difference + 0.5 * ad_product(d_, u1 + u2) + A_ * twice + B_ * four;
}

Matrix6d strain_rate_gradient(const Vector6d& d, const Vector6d& u1, const Vector6d& u2) {
  const InverseTangentCoefficients k = inverse_tangent_coefficients(d.tail<3>().squaredNorm());
  const Matrix6d N = ad(d);
  const Vector6d difference = u2 - u1;
  const Vector6d s1 = N * difference, s2 = N * s1, s3 = N * s2, s4 = N * s3;
  // Product rule on N, N², N⁴ with d(ad(d) s) = −ad(s) dd, then on A(φ²) and B(φ²).
  const Matrix6d twice = ad(s1) + N * ad(difference);
  Matrix6d G = -0.5 * ad(u1 + u2) - k.A * twice - k.B * (ad(s3) + N * (ad(s2) + N * twice));
  G.rightCols<3>() += 2 * (k.dA * s2 + k.dB * s4) * d.tail<3>().transpose();
  return G;
}

GeometricStiffness geometric_stiffness(const Vector6d& d, const Vector6d& sigma) {
  const InverseTangentCoefficients k = inverse_tangent_coefficients(d.tail<3>().squaredNorm());
  const Matrix6d N = ad(d).transpose();
  const Vector6d s1 = N * sigma, s2 = N * s1, s3 = N * s2, s4 = N * s3;
  const Matrix6d C0 = ad_transpose_by_twist(sigma), C1 = ad_transpose_by_twist(s1);
  const Matrix6d C2 = ad_transpose_by_twist(s2), C3 = ad_transpose_by_twist(s3);
  // Product rule on N², N⁴, then on A(φ²) and B(φ²).
  Matrix6d even = k.A * (C1 + N * C0) + k.B * (C3 + N * (C2 + N * (C1 + N * C0)));
  even.rightCols<3>() += 2 * (k.dA * s2 + k.dB * s4) * d.tail<3>().transpose();
  return {even - 0.5 * C0, even + 0.5 * C0};
}

}  // namespace flexarm::geometry
