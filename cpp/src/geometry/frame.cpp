#include "flexarm/geometry/frame.hpp"

#include <cmath>

namespace flexarm::geometry {

series::Exponential<> series::exponential_beyond(double x) {
  if (x < small) return exponential_of_small(x);
  return exponential_by_sine(x, std::sqrt(x), [](double half) {
    return SineCosine<double>{std::sin(half), std::cos(half)};  // found together
  });
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

void log3_beyond(const double* R, double* omega) {
  Eigen::Map<Vector3d> found(omega);
  found = log3_beyond(Matrix3d(Eigen::Map<const Matrix3d>(R)));
}

}  // namespace flexarm::geometry
