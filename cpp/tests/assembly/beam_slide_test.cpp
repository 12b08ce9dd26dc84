#include "flexarm/assembly/beam_slide.hpp"

#include <doctest/doctest.h>

#include "beams.hpp"
#include "numerics.hpp"

namespace flexarm::tests::beam_slide_test {

using namespace flexarm::geometry;
using flexarm::assembly::BeamSlide;

namespace {

constexpr double length = 0.8;

/// Three elements, bent by up to 0.3 rad each, and a point of node 3 somewhat beside the second.
struct Bent {
  BeamSlide slide;
  std::vector<Frame> frames;
};

Bent bent(unsigned seed) {
  Random random(seed);
  std::vector<flexarm::elements::BeamElement> beam;
  std::vector<Frame> frames = {exp6(random.twist(2, 2))};
  for (int k = 0; k < 3; ++k) {
    beam.push_back(straight_beam(length, plump, 0, k, k + 1));
    Vector6d d = random.twist(0.02, 0.3);
    d[0] += length;
    frames.push_back(frames.back() * exp6(d));
  }
  const Frame middle = beam[1].interpolate(frames[1], frames[2], 0.4);
  const Frame H = exp6(random.twist(2, 2));
  const Vector3d near = middle * Vector3d(0, 0.03, -0.02);
  frames.push_back(H);
  return {BeamSlide(beam, 4, H.inverse() * near), frames};
}

std::vector<Frame> moved(const std::vector<Frame>& frames, const VectorXd& h) {
  std::vector<Frame> found = frames;
  const int nodes[] = {1, 2, 4};
  for (int k = 0; k < 3; ++k) found[nodes[k]] = found[nodes[k]] * exp6(Vector6d(h.segment<6>(6 * k)));
  return found;
}

}  // namespace

TEST_CASE("A point slides in the element beside it, as far off the axis as it stands") {
  const Bent b = bent(1);
  CHECK(b.slide.touched(b.frames) == 1);
  CHECK(error(b.slide.residual(b.frames), Eigen::Vector2d(0.03, -0.02)) < 1e-12);
}

TEST_CASE("Jacobian, geometric stiffness and convective term of a slide are derivatives") {
  for (unsigned seed = 2; seed < 5; ++seed) {
    const Bent b = bent(seed);
    const auto gap = [&](const VectorXd& h) -> VectorXd { return b.slide.residual(moved(b.frames, h)); };
    CHECK(error(b.slide.jacobian(b.frames), differences(gap, 18)) < 1e-8);
    const Eigen::Vector2d lambda = Random(seed).vector(2, 4);
    const auto forces = [&](const VectorXd& h) -> VectorXd {
      return b.slide.jacobian(moved(b.frames, h)).transpose() * lambda;
    };
    CHECK(error(b.slide.geometric_stiffness(b.frames, lambda), differences(forces, 18)) < 2e-5);
    VectorXd v = VectorXd::Zero(30);
    const VectorXd own = Random(seed).vector(18);
    v.segment<12>(6) = own.head<12>();
    v.segment<6>(24) = own.tail<6>();
    const auto rate = [&](const VectorXd& t) -> VectorXd {
      return b.slide.jacobian(moved(b.frames, t[0] * own)) * own;
    };
    CHECK(error(b.slide.convective(b.frames, v), differences(rate, 1)) < 1e-6);
  }
}

TEST_CASE("The force of a slide is normal to the axis where it touches") {
  const Bent b = bent(6);
  const Eigen::Vector2d lambda(3, -2);
  const auto beam = straight_beam(length, plump, 0, 1, 2);
  const double xi = 0.4, h = 1e-5;
  const Vector3d tangent = beam.interpolate(b.frames[1], b.frames[2], xi + h).x -
                           beam.interpolate(b.frames[1], b.frames[2], xi - h).x;
  // on the axis itself; beside it the section turns with the point
  const BeamSlide on_axis({beam}, 4,
                          b.frames[4].inverse() * beam.interpolate(b.frames[1], b.frames[2], xi).x);
  CHECK(std::abs(on_axis.force_on_b(b.frames, lambda).dot(tangent.normalized())) < 1e-8);
}

}  // namespace flexarm::tests::beam_slide_test
