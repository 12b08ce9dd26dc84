/// The plane's own closed forms against those of space, from which they must not differ.
#include "flexarm/geometry/plane.hpp"

#include <doctest/doctest.h>

#include <numbers>

#include "numerics.hpp"

namespace flexarm::tests::plane_test {

using namespace flexarm::geometry;

namespace {

/// On both sides of every switch between series and closed forms.
const std::vector<double> angles = {0.0,    1e-9,    1e-4,   0.003162, 0.003163, 0.00999, 0.01001, 0.0316,
                                    0.0317, 0.09999, 0.1002, 0.2001,   0.4999,   0.5001,  1.0,     2.9};

struct Case {
  PlaneAxes axes;
  Eigen::Matrix<double, 6, 3> P;
  Vector3d h, u, f;  // twists and a wrench of the plane
};

/// A plane anywhere in space, with a twist in it that turns by `angle`.
Case in_some_plane(double angle, Random& random) {
  Case c;
  c.axes = PlaneAxes::with_normal(random.unit(), random.unit());
  c.P = c.axes.within();
  c.h << random.vector(2, 2.0), random(-1, 1) < 0 ? -angle : angle;
  c.u = random.vector(3);
  c.f = random.vector(3, 5.0);
  return c;
}

}  // namespace

TEST_CASE("Exponential, logarithm and products of SE(2) are those of SE(3) in a plane") {
  Random random(1);
  for (double angle : angles) {
    CAPTURE(angle);
    const Case c = in_some_plane(angle, random);
    const FrameIn<2> H = exponential<2>(c.h);
    const Frame full = exp6(c.P * c.h);
    const FrameIn<2> seen = in_plane(full, c.axes, c.axes);
    CHECK(error(H.R, seen.R) < 1e-14);
    CHECK(error(H.x, seen.x) < 1e-14);
    CHECK(tilt(full, c.axes, c.axes) < 1e-15);
    CHECK(error(logarithm<2>(H), c.h) < 1e-14);
    CHECK(error(c.P.transpose() * adjoint(full) * c.P, adjoint<2>(H)) < 1e-14);
    CHECK(error(adjoint_product<2>(H, c.u), adjoint<2>(H) * c.u) < 1e-15);
    CHECK(error(adjoint_transpose_product<2>(H, c.f), adjoint<2>(H).transpose() * c.f) < 1e-15);

    const FrameIn<2> G = exponential<2>(c.u);
    const Frame back = in_space(relative<2>(H, G), 0, c.axes, c.axes);
    const Frame expected = relative(full, exp6(c.P * c.u));
    CHECK(error(back.R, expected.R) < 1e-14);
    CHECK(error(back.x, expected.x) < 1e-14);

    CHECK(error(c.P * ad_product<2>(c.h, c.u), ad_product(c.P * c.h, c.P * c.u)) < 1e-14);
    CHECK(error(c.P * ad_transpose<2>(c.h, c.f), ad_transpose(c.P * c.h, c.P * c.f)) < 1e-14);
    CHECK(error(ad<2>(c.h), c.P.transpose() * ad(c.P * c.h) * c.P) < 1e-15);
    CHECK(error(ad_transpose_by_twist<2>(c.f), c.P.transpose() * ad_transpose_by_twist(c.P * c.f) * c.P) <
          1e-14);
  }
}

TEST_CASE("Tangent operators and geometric stiffness of SE(2) are those of SE(3) in a plane") {
  Random random(2);
  for (double angle : angles) {
    CAPTURE(angle);
    const Case c = in_some_plane(angle, random);
    const Vector6d d = c.P * c.h, sigma = c.P * c.f, u1 = c.P * c.u, u2 = c.P * c.f;
    const auto within = [&](const Matrix6d& A) -> Matrix3d { return c.P.transpose() * A * c.P; };
    CHECK(error(right_tangent_inverse<2>(c.h), within(right_tangent_inverse(d))) < 1e-13);
    CHECK(error(right_tangent<2>(c.h), within(right_tangent(d))) < 1e-13);

    const InverseTangentIn<2> flat(c.h);
    const InverseTangent full(d);
    CHECK(error(c.P * flat.transpose_times(c.f).left, full.transpose_times(sigma).left) < 1e-13);
    CHECK(error(c.P * flat.transpose_times(c.f).right, full.transpose_times(sigma).right) < 1e-13);
    CHECK(error(c.P * flat.strain_rate(c.u, c.f), full.strain_rate(u1, u2)) < 1e-13);

    const auto K = geometric_stiffness<2>(c.h, c.f);
    CHECK(error(K.left, within(geometric_stiffness(d, sigma).left)) < 1e-12);
    CHECK(error(K.right, within(geometric_stiffness(d, sigma).right)) < 1e-12);
    CHECK(error(strain_rate_gradient<2>(c.h, c.u, c.f), within(strain_rate_gradient(d, u1, u2))) < 1e-12);
  }
}

}  // namespace flexarm::tests::plane_test
