#include "flexarm/lanes/lane_pivots.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "flexarm/simd/pack.hpp"
#include "numerics.hpp"

namespace flexarm::tests::lane_pivots_test {

using namespace flexarm;

namespace {

using Pair = geometry::Pack<2, struct AnyProcessor>;
using Square = Eigen::Matrix<Pair, 5, 5, Eigen::RowMajor>;
using Sides = Eigen::Matrix<Pair, 5, 1>;

template <class Matrix>
auto lane_of(const Matrix& m, int lane) {
  Eigen::Matrix<double, Matrix::RowsAtCompileTime, Matrix::ColsAtCompileTime> own;
  for (int i = 0; i < m.rows(); ++i) {
    for (int j = 0; j < m.cols(); ++j) own(i, j) = m(i, j)[lane];
  }
  return own;
}

/// Two systems, whose largest entries lie in other rows where `apart`.
void check_lanes(bool apart) {
  tests::Random random(5);
  Eigen::Matrix<double, 5, 5> R;
  for (int k = 0; k < 5; ++k) R.row(k) = random.vector(5);
  const Eigen::Matrix<double, 5, 1> b = random.vector(5);
  Square A;
  Sides B;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) {
      A(i, j) = Pair(R(i, j));
      A(i, j).set(1, apart ? R((i + 1) % 5, j) : 2 * R(i, j));
    }
    B[i] = Pair(b[i]);
    B[i].set(1, b[(i + 1) % 5]);
  }
  const Square A_before = A;
  const Sides B_before = B;
  std::vector<Pair> row(5), inverse(5);
  lanes::LanePivots<Pair> pivots{row.data(), inverse.data()};
  linear_solvers::factor_in_place(A, pivots);
  linear_solvers::substitute(A, pivots, B);
  for (int lane = 0; lane < 2; ++lane) {
    Eigen::Matrix<double, 5, 5, Eigen::RowMajor> own = lane_of(A_before, lane);
    Eigen::Matrix<double, 5, 1> x = lane_of(B_before, lane);
    linear_solvers::eliminate(own, x);
    CHECK(lane_of(B, lane) == x);
    CHECK((lane_of(A_before, lane) * x - lane_of(B_before, lane)).norm() < 1e-13);
  }
  CHECK((row[0][0] != row[0][1]) == apart);
}

}  // namespace

TEST_CASE(
    "each lane is eliminated as its numbers alone, whether lanes have "
    "the same pivots or not") {
  check_lanes(false);
  check_lanes(true);
}

}  // namespace flexarm::tests::lane_pivots_test
