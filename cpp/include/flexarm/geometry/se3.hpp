/// @file
/// The special Euclidean group SE(3): frames, their logarithms, and the tangent operators of the exponential.
///
/// A frame H = (R, x) maps components in its own axes to its parent's: p_parent = R p + x. Twists, increments
/// and wrenches are 6-vectors (translation, rotation) and (force, moment) in the axes of the frame they
/// belong to.
///
///     exp(h) = (exp(ω~), V(ω) ρ),            h = (ρ, ω)                                  (1)
///     Ad_H   = [R  x~R; 0  R]                 twist in H's axes -> twist in the parent's  (2)
///     ad(h)  = [ω~  ρ~; 0  ω~]                                                            (3)
///     exp(h)⁻¹ d exp(h) = T_r(h) dh,          T_r(h) = Σ (−1)^k ad(h)^k / (k + 1)!        (4)
///     d exp(h) exp(h)⁻¹ = T_l(h) dh,          T_l(h) = T_r(−h)                            (5)
///     T_r⁻¹(h) = I + ½ ad + A(φ²) ad² + B(φ²) ad⁴,   φ = |ω|                              (6)
///
/// Equation (6) is exact, because ad (ad² + φ²)² = 0; with α = (φ/2) cot(φ/2) and β = (φ/2)²/sin²(φ/2),
/// A = 2 (1 − α)/φ² + (α − β)/(2 φ²) and B = (1 − α)/φ⁴ + (α − β)/(2 φ⁴). Small angles use the power series
/// in φ². Sources: [Bullo1995] for (6), [Sonneville2014] for the notation; docs/theory.md, section "Frames".
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace flexarm::geometry {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Cross-product matrix: skew(a) b = a × b.
Matrix3d skew(const Vector3d& a);

/// A rigid placement H = (R, x).
struct Frame {
  Matrix3d R = Matrix3d::Identity();
  Vector3d x = Vector3d::Zero();

  static Frame translation(const Vector3d& x) { return {Matrix3d::Identity(), x}; }
  static Frame rotation(const Matrix3d& R) { return {R, Vector3d::Zero()}; }

  Frame operator*(const Frame& other) const { return {R * other.R, x + R * other.x}; }
  Vector3d operator*(const Vector3d& point) const { return x + R * point; }
  Frame inverse() const { return {R.transpose(), -(R.transpose() * x)}; }
};

/// H1⁻¹ H2, the placement of frame 2 seen from frame 1.
Frame relative(const Frame& H1, const Frame& H2);

/// Equation (1). Exact for every argument.
Frame exp6(const Vector6d& h);

/// Inverse of (1) with rotation angle in [0, π].
Vector6d log6(const Frame& H);

/// Rotation matrix of a rotation vector, and back (angle in [0, π]).
Matrix3d exp3(const Vector3d& omega);
Vector3d log3(const Matrix3d& R);

/// Equation (2).
Matrix6d adjoint(const Frame& H);

/// Equation (3).
Matrix6d ad(const Vector6d& h);

/// ad(h)ᵀ f for a wrench f = (n, m): (n × ω, n × ρ + m × ω).
Vector6d ad_transpose(const Vector6d& h, const Vector6d& f);

/// ad(h) u for a twist u = (σ, τ): (ω × σ + ρ × τ, ω × τ).
Vector6d ad_product(const Vector6d& h, const Vector6d& u);

/// Matrix C(f) with ad(h)ᵀ f = C(f) h, for derivatives with respect to h.
Matrix6d ad_transpose_by_twist(const Vector6d& f);

/// Coefficients A, B of (6) and their derivatives with respect to φ².
struct InverseTangentCoefficients {
  double A, B, dA, dB;
};
InverseTangentCoefficients inverse_tangent_coefficients(double phi_squared);

/// Equation (6) and its mirror image T_l⁻¹(h) = T_r⁻¹(−h).
Matrix6d right_tangent_inverse(const Vector6d& h);
Matrix6d left_tangent_inverse(const Vector6d& h);

/// T_r(h) of (4), as the inverse of (6).
Matrix6d right_tangent(const Vector6d& h);

/// The products with (6) that a two-node element needs, without forming 6 × 6 matrices.
///
/// For a strain d and a stress σ it yields T_r⁻ᵀ(d) σ and T_l⁻ᵀ(d) σ; for two twists it yields the strain
/// rate T_r⁻¹(d) u₂ − T_l⁻¹(d) u₁. The even and odd parts of (6) are shared between the two ends.
class InverseTangent {
 public:
  explicit InverseTangent(const Vector6d& d);

  struct Pair {
    Vector6d left, right;
  };
  /// (T_l⁻ᵀ σ, T_r⁻ᵀ σ)
  Pair transpose_times(const Vector6d& sigma) const;
  /// T_r⁻¹ u₂ − T_l⁻¹ u₁
  Vector6d strain_rate(const Vector6d& u1, const Vector6d& u2) const;

 private:
  Vector6d d_;
  double A_, B_;
};

/// Derivative of the strain rate T_r⁻¹(d) u₂ − T_l⁻¹(d) u₁ with respect to d at fixed twists.
Matrix6d strain_rate_gradient(const Vector6d& d, const Vector6d& u1, const Vector6d& u2);

/// Derivatives of T_l⁻ᵀ(d) σ and T_r⁻ᵀ(d) σ with respect to d at fixed σ: the geometric stiffness of an
/// element.
struct GeometricStiffness {
  Matrix6d left, right;
};
GeometricStiffness geometric_stiffness(const Vector6d& d, const Vector6d& sigma);

}  // namespace flexarm::geometry
