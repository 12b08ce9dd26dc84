#include "flexarm/linear_solvers/supernodal_factor.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <chrono>
#include <limits>
#include <thread>

#include "flexarm/interrupt.hpp"
#include "patterns.hpp"

namespace flexarm::tests::supernodal_factor_test {

using flexarm::linear_solvers::SupernodalFactor;
using flexarm::linear_solvers::Supernodes;
using flexarm::linear_solvers::supernodes;

namespace {

/// Two groups of unknowns that couple with every one of a full third group, not with one another.
SparseMatrix two_groups(int group, int shared) {
  const int n = 2 * group + shared;
  MatrixXd A = MatrixXd::Identity(n, n) * (2.0 * n);
  Random random(3);
  for (int j = 0; j < n; ++j)
    for (int i = j + 1; i < n; ++i) {
      const bool apart = j < group && i >= group && i < 2 * group;
      if (!apart) A(i, j) = random(-1, 1);
    }
  return A.sparseView();
}

MatrixXd random_columns(Random& random, Eigen::Index rows, Eigen::Index columns) {
  return Eigen::Map<const MatrixXd>(random.vector(rows * columns).data(), rows, columns);
}

/// Smallest pivot of the dense factor in the same order, in parts of the diagonal of A.
double smallest_pivot(const SparseMatrix& A, const Supernodes& nodes) {
  const MatrixXd ordered = full(A)(nodes.order, nodes.order);
  const VectorXd diagonal = MatrixXd(ordered.llt().matrixL()).diagonal();
  return (diagonal.cwiseAbs2().cwiseQuotient(ordered.diagonal())).minCoeff();
}

struct Stop {};

}  // namespace

TEST_CASE("Random systems have the solutions and pivots of a dense factor and of Eigen's sparse one") {
  Random random(11);
  for (int trial = 0; trial < 150; ++trial) {
    CAPTURE(trial);
    const SparseMatrix A = random_matrix(random, trial % 2 == 0 ? 2.0 : 8.0);
    const MatrixXd B = random_columns(random, A.rows(), 1 + trial % 9);
    const Supernodes nodes = supernodes(A);
    const SupernodalFactor factor(A, nodes);
    MatrixXd X = B;
    factor.solve(X);
    CHECK(relative_error(X, full(A).llt().solve(B)) < 1e-12);  // conditions stay below a thousand
    const Eigen::SimplicialLLT<SparseMatrix> sparse(A);
    CHECK(relative_error(X, sparse.solve(B)) < 1e-12);
    CHECK(factor.least_pivot().part == near(smallest_pivot(A, nodes), 1e-10));
  }
}

TEST_CASE("Supernodes longer than a strip and rests wider than a slab are factored as well") {
  Random random(12);
  for (const auto& [group, shared] : {std::pair{150, 90}, std::pair{10, 1100}}) {
    CAPTURE(group);
    const SparseMatrix A = two_groups(group, shared);
    const MatrixXd B = random_columns(random, A.rows(), 3);
    const Supernodes nodes = supernodes(A);
    MatrixXd X = B;
    SupernodalFactor(A, nodes).solve(X);
    CHECK(relative_error(X, full(A).llt().solve(B)) < 1e-12);
    CHECK(relative_error(full(A) * X, B) < 1e-12);
  }
}

TEST_CASE("Each of many right sides is solved as it is alone") {
  Random random(13);
  const SparseMatrix A = random_matrix(random, 4);
  const Supernodes nodes = supernodes(A);
  const SupernodalFactor factor(A, nodes);
  const MatrixXd B = random_columns(random, A.rows(), 41);
  MatrixXd X = B;
  factor.solve(X);
  for (int k = 0; k < B.cols(); ++k) {
    MatrixXd x = B.col(k);
    factor.solve(x);
    CHECK(relative_error(X.col(k), x) < 1e-14);
  }
  MatrixXd none(A.rows(), 0);
  factor.solve(none);
}

TEST_CASE("A pivot that is not positive is told with its column, and ends the factorisation") {
  Random random(14);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int trial = 0; trial < 60; ++trial) {
    CAPTURE(trial);
    SparseMatrix A = random_matrix(random, 3);
    const Eigen::Index k = static_cast<Eigen::Index>(random(0, static_cast<double>(A.cols())));
    const double bad = std::array{-A.coeff(k, k), 0.0, nan}[trial % 3];
    A.coeffRef(k, k) = bad;
    const Supernodes nodes = supernodes(A);
    const SupernodalFactor factor(A, nodes);
    CHECK_FALSE(factor.least_pivot().part > 0);
    CHECK(factor.least_pivot().column == k);
  }
}

TEST_CASE("Factorisation and solution end when they are told to") {
  const SparseMatrix A = two_groups(20, 40);
  const Supernodes nodes = supernodes(A);
  const SupernodalFactor factor(A, nodes);
  const auto wait = [] { std::this_thread::sleep_for(std::chrono::milliseconds(25)); };  // 50 checks a second
  flexarm::set_interrupt_check([] { throw Stop{}; });
  wait();
  CHECK_THROWS_AS(SupernodalFactor(A, nodes), Stop);
  MatrixXd X = MatrixXd::Ones(A.rows(), 2);
  wait();
  CHECK_THROWS_AS(factor.solve(X), Stop);
  flexarm::set_interrupt_check(nullptr);
}

}  // namespace flexarm::tests::supernodal_factor_test
