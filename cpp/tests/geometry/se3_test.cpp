#include "flexarm/geometry/se3.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <numbers>

#include "numerics.hpp"

namespace flexarm::tests::se3_test {

using namespace flexarm::geometry;
using std::numbers::pi;

namespace {

/// Angles on both sides of every switch between series and closed forms: φ² = 1e-5, 0.04 (exp), 1e-4, 0.04
/// (V⁻¹), sin φ = 0.01, 0.1 (log), φ² = 0.25 (T⁻¹).
const std::vector<double> angles = {0.0,     1e-12,   1e-8,   1e-4,    0.003162, 0.003163, 0.00999,
                                    0.01001, 0.09999, 0.1002, 0.19999, 0.20001,  0.4999,   0.5001,
                                    1.0,     2.0,     3.0,    3.14,    pi - 1e-6};

Vector6d twist_of_angle(double angle, Random& random) {
  Vector6d h;
  h << random.vector(3, 2.0), angle * random.unit();
  return h;
}

/// Σ ad^k c_k with c_k = sign^k / (k + 1)! (tangent operators) or 1/k! (exponential).
Matrix6d power_series(const Matrix6d& a, bool tangent) {
  Matrix6d sum = Matrix6d::Identity(), term = Matrix6d::Identity();
  for (int k = 1; k < 60; ++k) {
    term = (term * a / (tangent ? k + 1 : k)).eval();
    sum += term;
  }
  return sum;
}

MatrixXd frame_matrix(const Frame& H) {
  MatrixXd A(3, 4);
  A << H.R, H.x;
  return A;
}

}  // namespace

TEST_CASE("log inverts exp for rotations from zero to just below a half turn") {
  Random random(1);
  for (double angle : angles) {
    CAPTURE(angle);
    for (int n = 0; n < 5; ++n) {
      const Vector6d h = twist_of_angle(angle, random);
      CHECK(error(log6(exp6(h)), h) < 1e-13 * (1 + 1 / (pi - angle)));
    }
  }
}

TEST_CASE("exp inverts log for a half turn, whose axis is known up to its sign only") {
  Random random(2);
  for (int n = 0; n < 10; ++n) {
    const Frame H = exp6(twist_of_angle(pi, random));
    const Vector6d h = log6(H);
    CHECK(h.tail<3>().norm() == near(pi, 1e-12));
    CHECK(error(frame_matrix(exp6(h)), frame_matrix(H)) < 1e-12);
  }
}

TEST_CASE("exp is the exponential of the 4 x 4 matrix [ω~ ρ; 0 0]") {
  Random random(3);
  for (double angle : angles) {
    const Vector6d h = twist_of_angle(angle, random);
    Eigen::Matrix4d X = Eigen::Matrix4d::Zero(), sum = Eigen::Matrix4d::Identity(), term = sum;
    X.topLeftCorner<3, 3>() = skew(h.tail<3>());
    X.topRightCorner<3, 1>() = h.head<3>();
    for (int k = 1; k < 50; ++k) sum += (term = (term * X / k).eval());
    CAPTURE(angle);
    CHECK(error(frame_matrix(exp6(h)), sum.topRows<3>()) < 1e-13);
    CHECK(error(exp3(h.tail<3>()), sum.topLeftCorner<3, 3>()) < 1e-13);
  }
}

TEST_CASE("Frames form a group") {
  Random random(4);
  const Frame A = exp6(random.twist(1, 1)), B = exp6(random.twist(1, 2)), C = exp6(random.twist(1, 1));
  CHECK(error(frame_matrix((A * B) * C), frame_matrix(A * (B * C))) < 1e-14);
  CHECK(error(frame_matrix(A * A.inverse()), frame_matrix(Frame{})) < 1e-15);
  CHECK(error(frame_matrix(A * relative(A, B)), frame_matrix(B)) < 1e-15);
  const Vector3d p = random.vector(3);
  CHECK(error((A * B) * p, A * (B * p)) < 1e-15);
}

TEST_CASE("The adjoint action is a homomorphism, and its derivative is ad") {
  Random random(5);
  const Vector6d h = random.twist(1, 1), u = random.twist(1, 1), f = random.twist(1, 1);
  const Frame A = exp6(h), B = exp6(u);
  CHECK(error(adjoint(A * B), adjoint(A) * adjoint(B)) < 1e-14);
  CHECK(error(adjoint(A), power_series(ad(h), false)) < 1e-13);
  CHECK(error(adjoint_product<3>(A, u), adjoint(A) * u) < 1e-15);
  CHECK(error(adjoint_transpose_product<3>(A, f), adjoint(A).transpose() * f) < 1e-15);
  CHECK(error(ad(h) * u, -ad(u) * h) < 1e-15);
  CHECK(error(ad_product(h, u), ad(h) * u) < 1e-15);
  CHECK(error(ad_transpose(h, f), ad(h).transpose() * f) < 1e-15);
  CHECK(error(ad_transpose_by_twist(f) * h, ad(h).transpose() * f) < 1e-15);
  CHECK(error(ad(ad_product(h, u)), ad(h) * ad(u) - ad(u) * ad(h)) < 1e-15);  // Jacobi's identity
  // H exp(u) H⁻¹ = exp(Ad_H u)
  CHECK(error(frame_matrix(A * exp6(u) * A.inverse()), frame_matrix(exp6(adjoint(A) * u))) < 1e-14);
}

TEST_CASE("T_r is the series of eq. (4), and eq. (6) is its inverse for every angle") {
  Random random(6);
  for (double angle : angles) {
    const Vector6d h = twist_of_angle(angle, random);
    const Matrix6d series = power_series(-ad(h), true);
    CAPTURE(angle);
    CHECK(error(right_tangent_inverse(h) * series, Matrix6d::Identity()) < 2e-12);
    CHECK(error(right_tangent(h), series) < 2e-12);
    CHECK(error(left_tangent_inverse(h) * power_series(ad(h), true), Matrix6d::Identity()) < 2e-12);
    CHECK(error(adjoint(exp6(h)) * right_tangent(h), right_tangent(-h)) < 2e-12);  // T_l = Ad T_r
  }
}

TEST_CASE("T_r⁻¹ and T_l⁻¹ are the derivatives of log under increments on either side") {
  Random random(7);
  for (double angle : {0.0, 0.15, 0.45, 0.55, 1.5, 2.8}) {
    const Vector6d h = twist_of_angle(angle, random);
    const Frame H = exp6(h);
    CAPTURE(angle);
    const auto right = [&](const VectorXd& d) -> VectorXd { return log6(H * exp6(d)); };
    const auto left = [&](const VectorXd& d) -> VectorXd { return log6(exp6(d) * H); };
    CHECK(relative_error(right_tangent_inverse(h), differences(right, 6)) < 1e-8);
    CHECK(relative_error(left_tangent_inverse(h), differences(left, 6)) < 1e-8);
  }
}

TEST_CASE("The coefficients A, B and their derivatives agree across the switch from series to closed form") {
  const double gap = 1e-12;  // so small that the functions themselves do not change
  const auto below = inverse_tangent_coefficients(0.25 - gap),
             above = inverse_tangent_coefficients(0.25 + gap);
  CHECK(std::abs(above.A - below.A) < 1e-13);
  CHECK(std::abs(above.B - below.B) < 1e-13);
  CHECK(std::abs(above.dA - below.dA) < 1e-12);
  CHECK(std::abs(above.dB - below.dB) < 1e-12);
  // Limits for a vanishing angle: Bernoulli numbers B₂/2! and B₄/4!.
  CHECK(inverse_tangent_coefficients(0).A == near(1.0 / 12, 1e-15));
  CHECK(inverse_tangent_coefficients(0).B == near(-1.0 / 720, 1e-15));
}

TEST_CASE("dA and dB are the derivatives of A and B") {
  for (double x : {0.01, 0.2, 0.3, 1.0, 4.0, 9.0}) {
    CAPTURE(x);
    const auto k = inverse_tangent_coefficients(x);
    const double h = 2e-3 * std::sqrt(x);
    const auto A = [](double y) { return inverse_tangent_coefficients(y).A; };
    const auto B = [](double y) { return inverse_tangent_coefficients(y).B; };
    CHECK(std::abs(k.dA - derivative(A, x, h)) < 1e-9);
    CHECK(std::abs(k.dB - derivative(B, x, h)) < 1e-9);
  }
}

TEST_CASE("InverseTangent multiplies as the matrices do") {
  Random random(8);
  for (double angle : angles) {
    const Vector6d d = twist_of_angle(angle, random), sigma = random.twist(3, 3);
    const Vector6d u1 = random.twist(1, 1), u2 = random.twist(1, 1);
    const Matrix6d Tr = right_tangent_inverse(d), Tl = left_tangent_inverse(d);
    const InverseTangent tangent(d);
    const auto pair = tangent.transpose_times(sigma);
    CAPTURE(angle);
    CHECK(relative_error(pair.left, Tl.transpose() * sigma) < 1e-13);
    CHECK(relative_error(pair.right, Tr.transpose() * sigma) < 1e-13);
    CHECK(error(tangent.strain_rate(u1, u2), Tr * u2 - Tl * u1) < 1e-13);
  }
}

TEST_CASE("A common rigid motion has no strain rate") {
  Random random(9);
  const Vector6d d = random.twist(1, 1), u = random.twist(1, 1);
  // Node 2 follows node 1 rigidly: u₂ = Ad(exp(d)⁻¹) u₁.
  const Vector6d u2 = adjoint(exp6(-d)) * u;
  CHECK(largest(InverseTangent(d).strain_rate(u, u2)) < 1e-14);
}

TEST_CASE("The geometric stiffness is the derivative of the end forces at fixed stress") {
  Random random(10);
  for (double angle : {0.0, 0.1, 0.45, 0.55, 1.0, 2.5}) {
    const Vector6d d = twist_of_angle(angle, random), sigma = random.twist(3, 3);
    const auto K = geometric_stiffness(d, sigma);
    const auto left = [&](const VectorXd& x) -> VectorXd {
      return left_tangent_inverse(d + x).transpose() * sigma;
    };
    const auto right = [&](const VectorXd& x) -> VectorXd {
      return right_tangent_inverse(d + x).transpose() * sigma;
    };
    CAPTURE(angle);
    CHECK(relative_error(K.left, differences(left, 6)) < 1e-9);
    CHECK(relative_error(K.right, differences(right, 6)) < 1e-9);
  }
}

TEST_CASE("The strain rate's gradient is its derivative by the strain at fixed twists") {
  Random random(11);
  for (double angle : {0.0, 0.1, 0.45, 0.55, 1.0, 2.5}) {
    const Vector6d d = twist_of_angle(angle, random), u1 = random.twist(2, 2), u2 = random.twist(2, 2);
    const auto rate = [&](const VectorXd& x) -> VectorXd {
      return InverseTangent(d + x).strain_rate(u1, u2);
    };
    CAPTURE(angle);
    CHECK(relative_error(strain_rate_gradient(d, u1, u2), differences(rate, 6)) < 1e-9);
  }
}

}  // namespace flexarm::tests::se3_test
