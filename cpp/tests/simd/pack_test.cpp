#include "flexarm/simd/pack.hpp"

#include <doctest/doctest.h>

#include "flexarm/geometry/se3.hpp"

namespace flexarm::tests::pack_test {

using namespace flexarm::geometry;

namespace {

using Pair = Pack<2, struct AnyProcessor>;

template <int Rows, int Columns>
Eigen::Matrix<Pair, Rows, Columns> packed(const Eigen::Matrix<double, Rows, Columns>& first,
                                          const Eigen::Matrix<double, Rows, Columns>& second) {
  Eigen::Matrix<Pair, Rows, Columns> both;
  for (int k = 0; k < Rows * Columns; ++k) {
    both.data()[k] = Pair(first.data()[k]);
    both.data()[k].set(1, second.data()[k]);
  }
  return both;
}

template <int Rows, int Columns>
Eigen::Matrix<double, Rows, Columns> unpacked(const Eigen::Matrix<Pair, Rows, Columns>& both, int lane) {
  Eigen::Matrix<double, Rows, Columns> one;
  for (int k = 0; k < Rows * Columns; ++k) one.data()[k] = both.data()[k][lane];
  return one;
}

}  // namespace

TEST_CASE(
    "exponential and logarithm of each lane are those of its numbers alone, whatever the other one is") {
  const double turns[] = {1e-8, 1e-3, 0.02, 0.15, 0.6, 3.0};
  for (const double one : turns) {
    for (const double other : turns) {
      const Twist<2> g(0.3, -0.4, one), h(-0.2, 0.7, -other);
      const FrameIn<2, Pair> both = exponential<2, Pair>(packed<3, 1>(g, h));
      const FrameIn<2, Pair> same = exponential<2, Pair>(packed<3, 1>(g, g));
      const Twist<2, Pair> back = logarithm<2>(both);
      for (int lane = 0; lane < 2; ++lane) {
        const FrameIn<2> H = exponential<2>(lane == 0 ? g : h);
        CHECK((unpacked(both.R, lane) - H.R).norm() < 1e-15);
        CHECK((unpacked(both.x, lane) - H.x).norm() < 1e-15);
        CHECK((unpacked(back, lane) - (lane == 0 ? g : h)).norm() < 1e-14);
      }
      CHECK(unpacked(both.x, 0) == unpacked(same.x, 0));
      CHECK(unpacked(back, 0) == unpacked(Twist<2, Pair>(logarithm<2>(same)), 0));
    }
  }
}

TEST_CASE("in space, too, and so are the products with the inverse tangent") {
  const double turns[] = {1e-8, 1e-3, 0.02, 0.15, 0.6, 3.0};
  const Vector6d u = (Vector6d() << 0.3, -1.2, 0.7, 0.4, 2.0, -0.9).finished();
  for (const double one : turns) {
    for (const double other : turns) {
      Vector6d g, h;
      g << 0.3, -0.4, 0.2, one * Vector3d(2, -1, 2) / 3;
      h << -0.2, 0.7, 0.1, other * Vector3d(-6, 2, 3) / 7;
      const auto both = packed<6, 1>(g, h), same = packed<6, 1>(g, g);
      const FrameIn<3, Pair> H = exponential<3, Pair>(both);
      const Twist<3, Pair> back = logarithm<3>(H);
      const InverseTangentIn<3, Pair> tangent(both), of_same(same);
      const auto pair = tangent.transpose_times(packed<6, 1>(u, u));
      for (int lane = 0; lane < 2; ++lane) {
        const Vector6d& own = lane == 0 ? g : h;
        CHECK((unpacked(H.R, lane) - exp6(own).R).norm() < 2e-15);
        CHECK((unpacked(H.x, lane) - exp6(own).x).norm() < 2e-15);
        CHECK((unpacked(back, lane) - own).norm() < 1e-14);
        const auto wanted = InverseTangent(own).transpose_times(u);
        CHECK((unpacked(pair.left, lane) - wanted.left).norm() < 1e-13);
        CHECK((unpacked(pair.right, lane) - wanted.right).norm() < 1e-13);
      }
      CHECK(unpacked(back, 0) == unpacked(Twist<3, Pair>(logarithm<3>(exponential<3, Pair>(same))), 0));
      CHECK(unpacked(pair.left, 0) == unpacked(of_same.transpose_times(packed<6, 1>(u, u)).left, 0));
    }
  }
}

TEST_CASE("numbers are chosen and compared lane by lane") {
  alignas(16) const double numbers[] = {-2.0, 3.0}, chosen[] = {0.0, 1.0};
  const Pair a = Pair::at(numbers);
  CHECK(a.magnitude()[0] == 2);
  CHECK(a.where(Pair::at(chosen))[0] == 0);
  CHECK(a.where(Pair::at(chosen))[1] == 3);
  CHECK(Pair::larger(a, Pair(1.0))[0] == 1);
  CHECK(a.all_below(3.5));
  CHECK_FALSE(a.all_below(3.0));
}

}  // namespace flexarm::tests::pack_test
