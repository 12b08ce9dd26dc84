/// @file
/// The names of space, D = 3, for what geometry/twist.hpp, frame.hpp and tangent.hpp define for any D.
#pragma once

#include "flexarm/geometry/frame.hpp"
#include "flexarm/geometry/tangent.hpp"
#include "flexarm/geometry/twist.hpp"

namespace flexarm::geometry {

using Frame = FrameIn<3>;
using InverseTangent = InverseTangentIn<3>;
using GeometricStiffness = GeometricStiffnessIn<3>;

inline Frame exp6(const Vector6d& h) { return exponential<3>(h); }
inline Vector6d log6(const Frame& H) { return logarithm<3>(H); }

inline Matrix6d ad(const Vector6d& h) { return ad<3>(h); }
inline Vector6d ad_transpose(const Vector6d& h, const Vector6d& f) { return ad_transpose<3>(h, f); }
inline Vector6d ad_product(const Vector6d& h, const Vector6d& u) { return ad_product<3>(h, u); }
inline Matrix6d ad_transpose_by_twist(const Vector6d& f) { return ad_transpose_by_twist<3>(f); }
inline Matrix6d right_tangent_inverse(const Vector6d& h) { return right_tangent_inverse<3>(h); }
inline Matrix6d left_tangent_inverse(const Vector6d& h) { return left_tangent_inverse<3>(h); }
inline Matrix6d right_tangent(const Vector6d& h) { return right_tangent<3>(h); }
inline InverseTangentCoefficients inverse_tangent_coefficients(double phi_squared) {
  return inverse_tangent_coefficients<3>(phi_squared);
}
inline Matrix6d strain_rate_gradient(const Vector6d& d, const Vector6d& u1, const Vector6d& u2) {
  return strain_rate_gradient<3>(d, u1, u2);
}
inline GeometricStiffness geometric_stiffness(const Vector6d& d, const Vector6d& sigma) {
  return geometric_stiffness<3>(d, sigma);
}

}  // namespace flexarm::geometry
