#include "flexarm/linear_solvers/panel_solve.hpp"

#include <doctest/doctest.h>

#include "flexarm/linear_solvers/wide_rows.hpp"
#include "numerics.hpp"

namespace flexarm::tests::panel_solve_test {

using namespace flexarm::linear_solvers;

namespace {

/// Columns of a supernode: n of them with a lower triangle on top, `height` rows in all, of which the factor
/// keeps what lies above the diagonal unused.
struct Columns {
  MatrixXd L;

  Columns(Random& random, int n, int height)
      : L(Eigen::Map<const MatrixXd>(random.vector(Eigen::Index(n) * height, 0.3).data(), height, n)) {
    for (int k = 0; k < n; ++k) L(k, k) = random(1, 2);
  }
  ConstPanel panel() const { return {L.data(), L.rows()}; }
  auto triangle() const { return L.topRows(L.cols()).triangularView<Eigen::Lower>(); }
  auto below() const { return L.bottomRows(L.rows() - L.cols()); }
};

}  // namespace

TEST_CASE("Solutions with a supernode's columns are those of its dense matrix") {
  Random random(21);
  for (const int width : {4, 8, 16})
    for (const int n : {1, 2, 3, 4, 5, 8, 11, 70})
      for (const int rest : {0, 1, 6, 33}) {
        CAPTURE(width);
        CAPTURE(n);
        CAPTURE(rest);
        const Columns columns(random, n, n + rest);
        const VectorXd numbers = random.vector(Eigen::Index(width) * (n + rest));
        const MatrixXd before = Eigen::Map<const MatrixXd>(numbers.data(), width, n + rest).transpose();
        MatrixXd forward = before.transpose(), backward = before.transpose();
        solve_forward(width, n, n + rest, columns.panel(), forward.data());
        MatrixXd expected = before;
        expected.topRows(n) = columns.triangle().solve(before.topRows(n));
        expected.bottomRows(rest) -= columns.below() * expected.topRows(n);
        CHECK(relative_error(forward.transpose(), expected) < 1e-13);
        solve_backward(width, n, n + rest, columns.panel(), backward.data());
        expected = before;
        expected.topRows(n) -= columns.below().transpose() * before.bottomRows(rest);
        const MatrixXd upper = MatrixXd(columns.triangle()).transpose();
        expected.topRows(n) = upper.triangularView<Eigen::Upper>().solve(expected.topRows(n)).eval();
        CHECK(relative_error(backward.transpose(), expected) < 1e-13);
      }
}

TEST_CASE("Few right sides are held in the narrowest width that takes them") {
  for (int columns = 1; columns <= 16; ++columns) {
    const int width = width_of(columns);
    CHECK(width >= columns);
    CHECK((width == 4 || width / 2 < columns));
  }
  CHECK(width_of(40) == 16);
}

}  // namespace flexarm::tests::panel_solve_test
