#include <doctest/doctest.h>

#include <vector>

#include "flexarm/geometry/se3.hpp"

namespace flexarm::tests::two_test {

using namespace flexarm::geometry;

namespace {

/// Twists that turn by a hundredth of a microradian to nearly half a turn.
template <int D>
std::vector<Twist<D>> twists() {
  std::vector<Twist<D>> all;
  for (const double turn : {1e-8, 1e-3, 0.02, 0.15, 0.6, 3.0}) {
    Twist<D> h = Twist<D>::LinSpaced(0.3, -0.4);
    h.template tail<turns<D>>() *= turn / h.template tail<turns<D>>().norm();
    all.push_back(h);
  }
  return all;
}

/// Every twist beside every other one, so that lanes lie within and beyond the series' limits.
template <int D>
void check_all_pairs() {
  for (const Twist<D>& g : twists<D>()) {
    for (const Twist<D>& h : twists<D>()) {
      const FrameIn<D> G = exponential<D>(g), H = exponential<D>(h);
      const FrameIn<D, Two> both = exponential<D, Two>(side_by_side(g, h));
      CHECK((lane(both.R, 0) - G.R).norm() < 1e-15);
      CHECK((lane(both.x, 1) - H.x).norm() < 1e-15);
      const Twist<D, Two> back = logarithm<D>(side_by_side<D>(G, H));
      CHECK((lane(back, 0) - logarithm<D>(G)).norm() < 1e-15);
      CHECK((lane(back, 1) - logarithm<D>(H)).norm() < 1e-15);
      const InverseTangentIn<D, Two> tangents(side_by_side(g, h));
      const Twist<D> u = Twist<D>::LinSpaced(1, 2), w = Twist<D>::LinSpaced(2, -1);
      const Twist<D, Two> rates = tangents.strain_rate(side_by_side(u, w), side_by_side(w, u));
      CHECK((lane(rates, 0) - InverseTangentIn<D>(g).strain_rate(u, w)).norm() < 2e-14);
      CHECK((lane(rates, 1) - InverseTangentIn<D>(h).strain_rate(w, u)).norm() < 2e-14);
    }
  }
}

}  // namespace

TEST_CASE("frames of the plane side by side are those of each") { check_all_pairs<2>(); }

TEST_CASE("frames of space side by side are those of each") { check_all_pairs<3>(); }

}  // namespace flexarm::tests::two_test
