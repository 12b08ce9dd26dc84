#include "flexarm/eigen/block_lanczos.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <limits>
#include <numbers>

#include "flexarm/linear_solvers/cholesky_factor.hpp"
#include "numerics.hpp"

namespace flexarm::tests::block_lanczos_test {

using flexarm::eigen::block_lanczos;
using flexarm::eigen::LanczosModes;
using flexarm::eigen::LanczosOptions;
using flexarm::linear_solvers::CholeskyFactor;
using SparseMatrix = Eigen::SparseMatrix<double>;
using std::numbers::pi;

namespace {

/// A square membrane of n x n points, fixed all around, with the mass of its points spread over neighbours.
/// By symmetry most of its eigenvalues are double.
struct Membrane {
  SparseMatrix K, M;

  explicit Membrane(int n, double detuning = 0) : K(n * n, n * n), M(n * n, n * n) {
    std::vector<Eigen::Triplet<double>> k, m;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const int a = i * n + j;
        k.emplace_back(a, a, 4.0 + 2 * detuning);
        m.emplace_back(a, a, 2.0 / 3);
        if (j + 1 < n) {
          k.emplace_back(a + 1, a, -1.0);
          m.emplace_back(a + 1, a, 1.0 / 12);
        }
        if (i + 1 < n) {
          k.emplace_back(a + n, a, -1.0 - detuning);
          m.emplace_back(a + n, a, 1.0 / 12);
        }
      }
    K.setFromTriplets(k.begin(), k.end());
    M.setFromTriplets(m.begin(), m.end());
  }

  LanczosModes lowest(const LanczosOptions& options) const { return modes_of(K, M, options); }

  static LanczosModes modes_of(const SparseMatrix& K, const SparseMatrix& M, const LanczosOptions& options) {
    const CholeskyFactor factor(K);
    return block_lanczos(
        [&](const MatrixXd& F) {
          MatrixXd X = F;
          factor.solve(X);
          return X;
        },
        M, options);
  }
};

MatrixXd full(const SparseMatrix& A) { return MatrixXd(A).selfadjointView<Eigen::Lower>(); }

VectorXd dense_spectrum(const SparseMatrix& K, const SparseMatrix& M) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(full(K), full(M)).eigenvalues();
}

/// n copies of one chain of 6 masses, side by side: every eigenvalue n times.
SparseMatrix copies(int n, double diagonal, double neighbour) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < n; ++k)
    for (int i = 0; i < 6; ++i) {
      entries.emplace_back(6 * k + i, 6 * k + i, diagonal);
      if (i < 5) entries.emplace_back(6 * k + i + 1, 6 * k + i, neighbour);
    }
  SparseMatrix A(6 * n, 6 * n);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

}  // namespace

TEST_CASE("The lowest modes are those of the dense solver, double ones twice") {
  const Membrane membrane(15);
  const VectorXd expected = dense_spectrum(membrane.K, membrane.M);
  CHECK(expected[1] == near(expected[2], 1e-12));  // double indeed
  for (const int block : {1, 2, 4, 6, 12}) {
    CAPTURE(block);
    const LanczosModes found = membrane.lowest({.count = 14, .block = block});
    REQUIRE(found.lambda.size() == 14);
    CHECK(relative_error(found.lambda, expected.head(14)) < 1e-12);  // the square of the tolerance on (3)
    CHECK(found.next_lambda == near(expected[14], 1e-2));            // what a frequency limit needs
    CHECK(found.residual.maxCoeff() < 2e-7);  // in parts of a distance, what the tolerance asks
    const MatrixXd unit = found.shapes.transpose() * full(membrane.M) * found.shapes;
    CHECK(error(unit, MatrixXd::Identity(14, 14)) < 1e-12);
  }
}

TEST_CASE("All modes up to a limit are found, as many as the signature of K - limit M counts") {
  const Membrane membrane(14, 0.01);
  for (const double limit : {0.02, 0.3, 0.77, 1.9}) {
    CAPTURE(limit);
    const VectorXd pivots =
        Eigen::LDLT<MatrixXd>(full(membrane.K) - limit * full(membrane.M)).vectorD();  // Sylvester's inertia
    const Eigen::Index below = (pivots.array() < 0).count();
    const LanczosModes found = membrane.lowest({.max_lambda = limit});
    CHECK(found.lambda.size() == below);
    CHECK(found.next_lambda > limit);
    CHECK((found.lambda.array() <= limit).all());
  }
}

TEST_CASE("A limit below the first mode finds none and tells the first") {
  const Membrane membrane(14);
  const LanczosModes found = membrane.lowest({.max_lambda = 1e-4});
  CHECK(found.lambda.size() == 0);
  CHECK(found.shapes.cols() == 0);
  CHECK(found.next_lambda == near(dense_spectrum(membrane.K, membrane.M)[0], 1e-3));
}

TEST_CASE("More copies of a mode than the block has vectors are found all the same") {
  // Eleven equal chains: every value eleven times, with blocks of three and of six.
  const SparseMatrix K = copies(11, 2, -1), M = copies(11, 1, 0);
  const double first = 2 - 2 * std::cos(pi / 7), second = 2 - 2 * std::cos(2 * pi / 7);
  for (const int block : {3, 6}) {
    CAPTURE(block);
    SUBCASE("by limit") {
      const LanczosModes found = Membrane::modes_of(K, M, {.max_lambda = 1, .block = block});
      REQUIRE(found.lambda.size() == 22);
      CHECK(error(found.lambda.head(11), VectorXd::Constant(11, first)) < 1e-12);
      CHECK(error(found.lambda.tail(11), VectorXd::Constant(11, second)) < 1e-12);
    }
    SUBCASE("by count") {
      const LanczosModes found = Membrane::modes_of(K, M, {.count = 13, .block = block});
      REQUIRE(found.lambda.size() == 13);
      CHECK(error(found.lambda.head(11), VectorXd::Constant(11, first)) < 1e-12);
      CHECK(found.lambda[12] == near(second, 1e-12));
      CHECK(error(found.shapes.transpose() * found.shapes, MatrixXd::Identity(13, 13)) < 1e-12);
    }
  }
}

TEST_CASE("All modes of a small system are found, and not one more") {
  const SparseMatrix K = copies(2, 2, -1), M = copies(2, 1, 0);
  const LanczosModes found = Membrane::modes_of(K, M, {.count = 100, .block = 4});
  REQUIRE(found.lambda.size() == 12);
  CHECK(error(found.lambda, dense_spectrum(K, M)) < 1e-12);
  CHECK(found.next_lambda == std::numeric_limits<double>::infinity());
}

TEST_CASE("Massless motions are no modes") {
  SparseMatrix K = copies(2, 2, -1), M = copies(2, 1, 0);
  for (const int i : {1, 4, 8}) M.coeffRef(i, i) = 0;
  const LanczosModes found = Membrane::modes_of(K, M, {.count = 100, .block = 4});
  REQUIRE(found.lambda.size() == 9);
  CHECK(found.residual.maxCoeff() < 1e-10);
}

TEST_CASE("The residual bounds the error of its eigenvalue") {
  const Membrane membrane(12, 0.1);
  const VectorXd expected = dense_spectrum(membrane.K, membrane.M);
  const LanczosModes found = membrane.lowest({.count = 6, .block = 2, .tolerance = 5e-2});
  for (Eigen::Index k = 0; k < 6; ++k) {
    const double nearest = ((expected.array() - found.lambda[k]).abs() / expected.array()).minCoeff();
    CHECK(nearest <= found.residual[k] + 1e-12);  // rounding of a condition of 1e2
  }
  CHECK(found.residual.maxCoeff() > 1e-5);  // loose, so that the bound is put to the test
}

TEST_CASE("Equal input gives equal output") {
  const Membrane membrane(12);
  const LanczosModes a = membrane.lowest({.count = 5}), b = membrane.lowest({.count = 5});
  CHECK(error(a.shapes, b.shapes) == 0);
}

}  // namespace flexarm::tests::block_lanczos_test
