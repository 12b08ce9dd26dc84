#include <doctest/doctest.h>

#include <random>
#include <vector>

#include "beams.hpp"
#include "flexarm/elements/beam_pair.hpp"

namespace flexarm::tests::beam_pair_test {

using namespace flexarm::elements;
using namespace flexarm::geometry;

namespace {

/// Three nodes of two beams: bent by about `turn` [rad] and moving, from seeded numbers.
struct Motion {
  std::vector<Frame> frames;
  Eigen::VectorXd v, v_dot;

  explicit Motion(double turn) : v(18), v_dot(18) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    const auto number = [&](double) { return normal(random); };
    v = v.unaryExpr(number);
    v_dot = 10 * v_dot.unaryExpr(number);
    frames = {Frame{}};
    for (double length : {0.7, 0.9}) {
      Vector6d h = turn * Vector6d::Zero().unaryExpr(number).normalized();
      h[0] += length;
      frames.push_back(frames.back() * exp6(h));
    }
  }
};

/// Rows of all nodes, beam by beam.
Eigen::VectorXd one_by_one(const std::vector<BeamElement>& beams, const Motion& at) {
  Eigen::VectorXd r = Eigen::VectorXd::Zero(18);
  for (const BeamElement& beam : beams) {
    const int n1 = 6 * beam.node1(), n2 = 6 * beam.node2();
    Vector12d v, v_dot;
    v << at.v.segment<6>(n1), at.v.segment<6>(n2);
    v_dot << at.v_dot.segment<6>(n1), at.v_dot.segment<6>(n2);
    const auto f =
        beam.internal_forces(at.frames[beam.node1()], at.frames[beam.node2()], v.head<6>(), v.tail<6>());
    const Vector12d inertia = beam.inertia_forces(v, v_dot);
    r.segment<6>(n1) += f.f1 + inertia.head<6>();
    r.segment<6>(n2) += f.f2 + inertia.tail<6>();
  }
  return r;
}

}  // namespace

TEST_CASE("two beams side by side give the forces of each, however far they are bent") {
  for (const double damping_time : {0.0, 1e-3}) {
    const std::vector<BeamElement> beams = {straight_beam(0.7, plump, damping_time, 0, 1),
                                            straight_beam(0.9, plump, 0.0, 1, 2)};
    const BeamPairIn<3> pair(beams[0], beams[1]);
    for (const double turn : {1e-6, 0.02, 0.2, 2.0}) {  // across all limits of the series
      const Motion at(turn);
      Eigen::VectorXd r = Eigen::VectorXd::Zero(18);
      pair.add_forces(at.frames.data(), at.v.data(), at.v_dot.data(), r.data());
      const Eigen::VectorXd expected = one_by_one(beams, at);
      CHECK((r - expected).norm() <= 1e-14 * expected.norm());
    }
  }
}

TEST_CASE("beams with growing bows stay alone") {
  BeamElement growing = straight_beam(0.7, plump, 0, 0, 1);
  growing.set_bow(Vector6d::Constant(1e-3), 10.0);
  CHECK(!BeamPairIn<3>::suits(growing, straight_beam(0.9, plump, 0, 1, 2)));
  CHECK(BeamPairIn<3>::suits(straight_beam(0.7, plump, 0, 0, 1), straight_beam(0.9, plump, 0, 1, 2)));
}

}  // namespace flexarm::tests::beam_pair_test
