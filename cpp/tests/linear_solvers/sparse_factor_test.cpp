#include "flexarm/linear_solvers/sparse_factor.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>

#include "numerics.hpp"

namespace flexarm::tests::sparse_factor_test {

using flexarm::linear_solvers::SparseFactor;
using SparseMatrix = Eigen::SparseMatrix<double>;

namespace {

/// [A Jᵀ; J 0] with a banded A: the shape of a constrained arm, zeros on the diagonal included.
SparseMatrix saddle(int n, int m, unsigned seed) {
  Random random(seed);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i)
    for (int j = std::max(0, i - 4); j < std::min(n, i + 5); ++j)
      entries.emplace_back(i, j, random(-1, 1) + 4.0 * (i == j));
  for (int k = 0; k < m; ++k)
    for (int j = 3 * k; j < 3 * k + 4; ++j) {
      const double value = random(0.5, 1);
      entries.emplace_back(n + k, j, value);
      entries.emplace_back(j, n + k, value);
    }
  SparseMatrix S(n + m, n + m);
  S.setFromTriplets(entries.begin(), entries.end());
  return S;
}

/// Solves once by rows; later factorisations then use triangular_factors.hpp.
void solve_by_rows(const SparseFactor& factor, Eigen::Index n) {
  SparseFactor::Rows rows = SparseFactor::Rows::Ones(n, 3);
  factor.solve(rows);
}

}  // namespace

TEST_CASE("New numbers in an old pattern are factored as if for the first time") {
  for (const bool by_rows : {false, true}) {
    Random random(1);
    SparseFactor factor;
    for (unsigned seed = 1; seed < 6; ++seed) {
      const SparseMatrix A = saddle(40, 8, seed);
      REQUIRE(factor.factor(A));
      if (by_rows) solve_by_rows(factor, 48);
      const VectorXd x = random.vector(48);
      VectorXd y = A * x;
      factor.solve(y);
      CHECK(error(y, x) < 1e-11);
    }
    CHECK(factor.factorisations() == 5);
  }
}

TEST_CASE("Right sides stored by rows have the solutions of those stored by columns") {
  // A block triangular matrix, and one that has no such form; numbers change in between.
  Random random(9);
  MatrixXd blocks(9, 9);
  for (int k = 0; k < 9; ++k) blocks.col(k) = random.vector(9) + 4 * VectorXd::Unit(9, k);
  blocks.bottomLeftCorner(5, 4).setZero();
  const SparseMatrix triangular = blocks.sparseView();
  for (const SparseMatrix& A : {saddle(40, 8, 7), triangular}) {
    SparseFactor factor;
    for (const double share : {0.0, 0.2, -0.1}) {
      SparseMatrix B = A;
      for (Eigen::Index k = 0; k < B.nonZeros(); ++k) B.valuePtr()[k] *= 1 + share * random(-1, 1);
      REQUIRE(factor.factor(B));
      MatrixXd X(A.rows(), 7);
      for (int k = 0; k < X.cols(); ++k) X.col(k) = Random(k + 1u).vector(A.rows());
      SparseFactor::Rows rows = B * X;
      factor.solve(rows);
      CHECK(error(MatrixXd(rows), X) < 1e-11);
    }
  }
}

TEST_CASE("Numbers that need other pivots are pivoted anew") {
  // The first matrix pivots on its diagonal, the second on what was small then.
  SparseMatrix A(2, 2), B(2, 2);
  A.insert(0, 0) = 1;
  A.insert(0, 1) = 1e-3;
  A.insert(1, 0) = 1e-3;
  A.insert(1, 1) = 1;
  B.insert(0, 0) = 1e-17;
  B.insert(0, 1) = 1;
  B.insert(1, 0) = 1;
  B.insert(1, 1) = 1e-17;
  A.makeCompressed();
  B.makeCompressed();
  for (const bool by_rows : {false, true}) {
    SparseFactor factor;
    REQUIRE(factor.factor(A));
    if (by_rows) solve_by_rows(factor, 2);
    REQUIRE(factor.factor(B));
    VectorXd x(2);
    x << 3, 5;
    factor.solve(x);
    CHECK(x[0] == near(5));
    CHECK(x[1] == near(3));
  }
}

TEST_CASE("Several right sides are solved as each alone") {
  Random random(2);
  const SparseMatrix A = saddle(30, 5, 7);
  SparseFactor factor;
  REQUIRE(factor.factor(A));
  const MatrixXd X = Eigen::Map<const MatrixXd>(random.vector(35 * 4).data(), 35, 4);
  MatrixXd Y = A * X;
  factor.solve(Y);
  CHECK(error(Y, X) < 1e-11);
}

TEST_CASE("A singular matrix is found out, and a regular one after it is factored") {
  SparseMatrix A = saddle(20, 4, 3);
  const SparseMatrix regular = A;
  for (SparseMatrix::InnerIterator it(A, 5); it; ++it) it.valueRef() = 0;  // column 5 vanishes
  SparseFactor fresh;
  CHECK_FALSE(fresh.factor(A));
  for (const bool by_rows : {false, true}) {
    SparseFactor used;
    REQUIRE(used.factor(regular));
    if (by_rows) solve_by_rows(used, 24);
    CHECK_FALSE(used.factor(A));
    REQUIRE(used.factor(regular));
    VectorXd x = regular * VectorXd::Ones(24);
    used.solve(x);
    CHECK(error(x, VectorXd::Ones(24)) < 1e-11);
  }
}

TEST_CASE("A pattern may grow from one matrix to the next") {
  SparseFactor factor;
  const SparseMatrix A = saddle(20, 4, 5);
  REQUIRE(factor.factor(A));
  SparseMatrix grown = A;
  grown.coeffRef(0, 19) = 0.7;
  grown.coeffRef(19, 0) = -0.4;
  grown.makeCompressed();
  REQUIRE(factor.factor(grown));
  VectorXd x = grown * VectorXd::Ones(24);
  factor.solve(x);
  CHECK(error(x, VectorXd::Ones(24)) < 1e-11);
}

TEST_CASE("A factor moves with its owner") {
  const SparseMatrix A = saddle(20, 4, 9);
  SparseFactor first;
  REQUIRE(first.factor(A));
  const SparseFactor second = std::move(first);
  VectorXd x = A * VectorXd::Ones(24);
  second.solve(x);
  CHECK(error(x, VectorXd::Ones(24)) < 1e-11);
}

TEST_CASE("A matrix with a number that is not finite has no factors") {
  SparseMatrix A = saddle(20, 3, 5);
  SparseFactor factor;
  CHECK(factor.factor(A));
  const double kept = A.valuePtr()[7];
  for (const double bad : {std::nan(""), HUGE_VAL}) {
    A.valuePtr()[7] = bad;
    CHECK_FALSE(factor.factor(A));
  }
  A.valuePtr()[7] = kept;
  CHECK(factor.factor(A));
}

}  // namespace flexarm::tests::sparse_factor_test
