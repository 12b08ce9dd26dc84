#include "flexarm/geometry/frame.hpp"

#include <cmath>

namespace flexarm::geometry {

series::Exponential<> series::exponential_beyond(double x) {
  if (x < small) {  // the power series, by Horner's scheme
    return {
        1 + x * (-1.0 / 6 + x * (1.0 / 120 + x * (-1.0 / 5040 + x * (1.0 / 362880 - x * (1.0 / 39916800))))),
        0.5 + x * (-1.0 / 24 +
                   x * (1.0 / 720 + x * (-1.0 / 40320 + x * (1.0 / 3628800 - x * (1.0 / 479001600))))),
        1.0 / 6 + x * (-1.0 / 120 + x * (1.0 / 5040 + x * (-1.0 / 362880 +
                                                           x * (1.0 / 39916800 - x * (1.0 / 6227020800)))))};
  }
  const double phi = std::sqrt(x);
  const double half_sine = std::sin(0.5 * phi), half_cosine = std::cos(0.5 * phi);  // found together
  const double sine = 2 * half_sine * half_cosine;
  return {sine / phi, 2 * half_sine * half_sine / x, (phi - sine) / (x * phi)};
}

double series::inverse_v_beyond(double x) {
  if (x < small) {
    return 1.0 / 12 + x * (1.0 / 720 + x * (1.0 / 30240 + x * (1.0 / 1209600 + x * (1.0 / 47900160))));
  }
  const double half = 0.5 * std::sqrt(x);
  return (1 - half * std::cos(half) / std::sin(half)) / x;
}

Matrix3d exp3(const Vector3d& omega) {
  const auto [a, b, c] = series::exponential(omega.squaredNorm());
  Matrix3d R = b * omega * omega.transpose() + a * skew(omega);
  R.diagonal().array() += 1 - b * omega.squaredNorm();
  return R;
}

Vector3d log3_beyond(const Matrix3d& R) {
  Eigen::Quaterniond q(R);
  q.normalize();
  if (q.w() < 0) {
    q.coeffs() *= -1;
  }
  const double n = q.vec().norm();
  return q.vec() * (2 * std::atan2(n, q.w()) / n);
}

}  // namespace flexarm::geometry
