#include "flexarm/linear_solvers/elimination.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>

#include "arms.hpp"

namespace flexarm::tests::elimination_test {

using flexarm::linear_solvers::eliminate;

namespace {

template <int N>
using Square = Eigen::Matrix<double, N, N, Eigen::RowMajor>;
template <int N>
using Column = Eigen::Matrix<double, N, 1>;

}  // namespace

TEST_CASE("Elimination solves as Eigen's factors do") {
  Random random(7);
  for (int trial = 0; trial < 20; ++trial) {
    Square<8> A;
    for (int k = 0; k < 8; ++k) A.row(k) = random.vector(8);
    const Column<8> b = random.vector(8);
    const Column<8> expected = A.partialPivLu().solve(b);
    Square<8> lost = A;
    Column<8> x = b;
    eliminate(lost, x);
    CHECK(relative_error(x, expected) < 1e-11);
  }
}

TEST_CASE("Factors serve right sides that come later") {
  Random random(8);
  Square<16> A;
  for (int k = 0; k < 16; ++k) A.row(k) = random.vector(16);
  Square<16> LU = A;
  flexarm::linear_solvers::Pivots<24> pivots;
  factor_in_place(LU, pivots);
  for (int trial = 0; trial < 3; ++trial) {
    Eigen::Matrix<double, 16, 2> B;
    B << random.vector(16), random.vector(16);
    Eigen::Matrix<double, 16, 2> X = B;
    substitute(LU, pivots, X);
    CHECK(relative_error(A * X, B) < 1e-11);
  }
}

TEST_CASE("A pivot of zero is exchanged for the largest below it") {
  Square<3> A;
  A << 0, 1, 2, 1e-20, 1, 1, 4, 0, 8;
  Column<3> x{8, 5, 28};  // A (1, 2, 3) but for 1e-20
  eliminate(A, x);
  CHECK(x[0] == near(1));
  CHECK(x[1] == near(2));
  CHECK(x[2] == near(3));
}

TEST_CASE("A singular matrix is told by numbers that are not finite") {
  Square<2> A;
  A << 1, 2, 2, 4;
  Column<2> x{1, 0};
  eliminate(A, x);
  CHECK_FALSE(x.allFinite());
}

}  // namespace flexarm::tests::elimination_test
