#include "flexarm/linear_solvers/cholesky_factor.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>

#include "flexarm/linear_solvers/blas_info.hpp"
#include "flexarm/linear_solvers/fill_ordering.hpp"
#include "numerics.hpp"

namespace flexarm::tests::cholesky_factor_test {

using flexarm::linear_solvers::CholeskyFactor;
using flexarm::linear_solvers::CholeskyReport;
using flexarm::linear_solvers::NotPositiveDefinite;
using SparseMatrix = Eigen::SparseMatrix<double>;

namespace {

/// Lower triangle of the Laplacian of an n x n grid, `ground` at its first point.
SparseMatrix grid(int n, double ground) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto spring = [&](int a, int b) {
    entries.emplace_back(a, a, 1.0);
    entries.emplace_back(b, b, 1.0);
    entries.emplace_back(std::max(a, b), std::min(a, b), -1.0);
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      if (i + 1 < n) spring(i * n + j, (i + 1) * n + j);
      if (j + 1 < n) spring(i * n + j, i * n + j + 1);
    }
  entries.emplace_back(0, 0, ground);
  SparseMatrix A(n * n, n * n);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

MatrixXd full(const SparseMatrix& A) { return MatrixXd(A).selfadjointView<Eigen::Lower>(); }

}  // namespace

TEST_CASE("Many right sides, more than one block of them, are solved as a dense Cholesky solves them") {
  const SparseMatrix A = grid(12, 1);
  const MatrixXd B = Eigen::Map<const MatrixXd>(Random(1).vector(144 * 75).data(), 144, 75);
  const CholeskyFactor factor(A);
  MatrixXd X = B;
  factor.solve(X);
  CHECK(relative_error(X, full(A).llt().solve(B)) < 1e-11);
  MatrixXd few = B.leftCols(3);  // after many: the workspace shrinks
  factor.solve(few);
  CHECK(error(few, X.leftCols(3)) < 1e-11);
}

TEST_CASE("Columns of a larger matrix are solved where they lie") {
  const SparseMatrix A = grid(5, 1);
  const CholeskyFactor factor(A);
  MatrixXd X = MatrixXd::Ones(30, 4);
  factor.solve(X.block(2, 1, 25, 2));
  CHECK(error(full(A) * X.block(2, 1, 25, 2), MatrixXd::Ones(25, 2)) < 1e-12);
  CHECK(error(X.row(1), MatrixXd::Ones(1, 4)) == 0);
  CHECK(error(X.col(3), MatrixXd::Ones(30, 1)) == 0);
}

TEST_CASE("The factor tells its ordering, the one that fills less, and the entries of L") {
  const SparseMatrix A = grid(40, 1);
  const CholeskyReport report = CholeskyFactor(A).report();
  CAPTURE(report.backend);
  CHECK(report.entries >= A.nonZeros());        // L has the pattern of A at least
  CHECK(report.entries < 20.0 * A.nonZeros());  // and far fewer than the 41 of a band of width 40
  CHECK(report.operations > report.entries);
  CHECK(report.entries_amd >= report.entries);
  if (flexarm::linear_solvers::has_metis()) {
    CHECK(report.entries == std::min(report.entries_amd, report.entries_metis));
    CHECK((report.ordering == "METIS") == (report.entries_metis < report.entries_amd));
  } else {
    CHECK(report.ordering == "AMD");
  }
  CHECK(report.blas == flexarm::linear_solvers::loaded_blas());
  CHECK(report.backend == "supernodal");
}

TEST_CASE("A matrix that is not positive definite is refused, and the row named") {
  SUBCASE("indefinite") {
    SparseMatrix A = grid(6, 1);
    A.coeffRef(20, 20) = -3;
    try {
      const CholeskyFactor factor(A);
      FAIL("taken");
    } catch (const NotPositiveDefinite& error) {
      CHECK(error.column == 20);
      CHECK(std::string(error.what()).find("row 20") != std::string::npos);
    }
  }
  SUBCASE("singular: no ground") { CHECK_THROWS_AS(CholeskyFactor(grid(6, 0)), NotPositiveDefinite); }
  SUBCASE("singular to working precision") {
    CHECK_THROWS_AS(CholeskyFactor(grid(6, 1e-15)), NotPositiveDefinite);
  }
}

TEST_CASE("A soft matrix is not a singular one") {
  // 196 points on one ground of 1e-6: the last pivot is small, yet far above rounding.
  const SparseMatrix A = grid(14, 1e-6);
  MatrixXd x = full(A) * MatrixXd::Ones(196, 1);
  CholeskyFactor(A).solve(x);
  CHECK(error(x, MatrixXd::Ones(196, 1)) < 4e-7);  // condition 8/(1e-6/196) times rounding
}

}  // namespace flexarm::tests::cholesky_factor_test
