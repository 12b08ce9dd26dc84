#include "flexarm/linear_solvers/cached_factorisation.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "flexarm/linear_solvers/dissection.hpp"
#include "numerics.hpp"

namespace flexarm::tests::cached_factorisation_test {

using namespace flexarm::linear_solvers;
using SparseMatrix = Eigen::SparseMatrix<double>;

namespace {

/// A chain of blocks of three, each joined to the next, hung up by three constraints whose own block is zero:
/// the shape of a planar arm. Its first two blocks have entries in one triangle only.
SparseMatrix chain(int n_blocks, unsigned seed) {
  Random random(seed);
  std::vector<Eigen::Triplet<double>> entries;
  const int n = 3 * n_blocks;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      if (std::abs(i / 3 - j / 3) > 1 || (i < 3 && j >= 3 && j - i > 3)) continue;
      entries.emplace_back(i, j, random(-1, 1) + 5.0 * (i == j));
    }
  }
  for (int k = 0; k < 3; ++k) {
    entries.emplace_back(n + k, k, 1.5);
    entries.emplace_back(k, n + k, 1.5);
  }
  SparseMatrix A(n + 3, n + 3);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

/// Zero but for ones beside the diagonal: regular where n is even, and every odd piece of it is singular.
SparseMatrix path(int n) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k + 1 < n; ++k) {
    entries.emplace_back(k, k + 1, 1.0);
    entries.emplace_back(k + 1, k, 1.0);
  }
  SparseMatrix A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

/// A chain whose blocks carry unknowns of their own, as inner modes hang on a part: n with large pivots, each
/// coupled with two blocks, and with the one before it where they are paired.
SparseMatrix with_modes(const SparseMatrix& A, int n_modes, bool paired, unsigned seed) {
  Random random(seed);
  const int n = static_cast<int>(A.rows());
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < A.outerSize(); ++k) {
    for (SparseMatrix::InnerIterator it(A, k); it; ++it) entries.emplace_back(it.row(), it.col(), it.value());
  }
  for (int k = 0; k < n_modes; ++k) {
    const int first = 3 * (k / 4);
    entries.emplace_back(n + k, n + k, random(300, 4000));
    for (int j = first; j < first + 6; ++j) {
      entries.emplace_back(n + k, j, random(-1, 1));
      entries.emplace_back(j, n + k, random(-1, 1));
    }
    if (paired && k % 2 == 1) entries.emplace_back(n + k, n + k - 1, 0.7);
  }
  SparseMatrix B(n + n_modes, n + n_modes);
  B.setFromTriplets(entries.begin(), entries.end());
  return B;
}

/// Two matrices that do not touch one another.
SparseMatrix beside(const SparseMatrix& A, const SparseMatrix& B) {
  const Eigen::Index n = A.rows();
  MatrixXd both = MatrixXd::Zero(n + B.rows(), n + B.rows());
  both.topLeftCorner(n, n) = MatrixXd(A);
  both.bottomRightCorner(B.rows(), B.rows()) = MatrixXd(B);
  return both.sparseView();
}

VectorXd by_substitution(const SparseMatrix& A, VectorXd b) {
  SparseFactor factor;
  REQUIRE(factor.factor(A));
  factor.solve(b);
  return b;
}

}  // namespace

TEST_CASE("Parts of a dissected matrix do not touch, and each unknown has one place") {
  for (const SparseMatrix& A : {chain(2, 1), chain(25, 2), beside(chain(30, 3), chain(4, 4))}) {
    const Dissection cut = dissect(A, 12);
    std::vector<int> place(static_cast<std::size_t>(A.rows()), -1), all = cut.separator;
    for (std::size_t p = 0; p < cut.parts.size(); ++p) {
      CHECK(cut.parts[p].size() < 24);
      all.insert(all.end(), cut.parts[p].begin(), cut.parts[p].end());
      for (int k : cut.parts[p]) place[static_cast<std::size_t>(k)] = static_cast<int>(p);
    }
    std::sort(all.begin(), all.end());
    std::vector<int> unknowns(static_cast<std::size_t>(A.rows()));
    std::iota(unknowns.begin(), unknowns.end(), 0);
    CHECK(all == unknowns);
    CHECK(cut.separator.size() < static_cast<std::size_t>(A.rows()) / 3);
    int joining = 0;
    for (int column = 0; column < A.outerSize(); ++column) {
      for (SparseMatrix::InnerIterator it(A, column); it; ++it) {
        const int a = place[static_cast<std::size_t>(it.row())], b = place[static_cast<std::size_t>(column)];
        joining += a >= 0 && b >= 0 && a != b;
      }
    }
    CHECK(joining == 0);
  }
}

TEST_CASE("A dissected inverse solves as substitution does, whatever the number of parts") {
  Random random(5);
  for (int n_blocks : {1, 3, 6, 7, 13, 20, 40}) {
    const SparseMatrix A = chain(n_blocks, static_cast<unsigned>(n_blocks));
    DissectedInverse inverse;
    REQUIRE(inverse.invert(A));
    for (int k = 0; k < 3; ++k) {
      const VectorXd b = random.vector(static_cast<int>(A.rows()));
      VectorXd x = b;
      inverse.solve(x);
      CHECK(error(x, by_substitution(A, b)) < 1e-12);  // condition numbers near 10
    }
  }
}

TEST_CASE("A dissected inverse serves matrices that fall apart") {
  const SparseMatrix A = beside(chain(20, 8), chain(3, 9));
  DissectedInverse inverse;
  REQUIRE(inverse.invert(A));
  VectorXd x = A * VectorXd::LinSpaced(A.rows(), -1, 2);
  inverse.solve(x);
  CHECK(error(x, VectorXd::LinSpaced(A.rows(), -1, 2)) < 1e-12);
}

TEST_CASE("Unknowns with large pivots go first, but no two that touch each other") {
  for (bool paired : {false, true}) {
    const SparseMatrix A = with_modes(chain(20, 15), 60, paired, 16);
    DissectedInverse inverse;
    REQUIRE(inverse.invert(A));
    const VectorXd b = Random(17).vector(static_cast<int>(A.rows()));
    VectorXd x = b;
    inverse.solve(x);
    CHECK(error(x, by_substitution(A, b)) < 1e-12);
    CHECK(error(A * x, b) < 1e-12);
  }
}

TEST_CASE("Where a part is singular larger parts are tried") {
  const SparseMatrix A = path(64);
  DissectedInverse inverse;
  REQUIRE(inverse.invert(A));
  VectorXd x = A * VectorXd::LinSpaced(64, 1, 2);
  inverse.solve(x);
  CHECK(error(x, VectorXd::LinSpaced(64, 1, 2)) < 1e-13);
}

TEST_CASE("Where all parts tried are singular the inverse is refused and substitution takes over") {
  const SparseMatrix A = path(160);
  DissectedInverse inverse;
  CHECK_FALSE(inverse.invert(A));
  CachedFactorisation factor;
  REQUIRE(factor.factor(A));
  VectorXd x = A * VectorXd::LinSpaced(160, 1, 2);
  factor.solve(x);
  CHECK(error(x, VectorXd::LinSpaced(160, 1, 2)) < 1e-13);
}

TEST_CASE("Kept factors of small and of large matrices solve alike") {
  for (int n_blocks : {4, 20, 90}) {
    const SparseMatrix A = chain(n_blocks, 11);
    CachedFactorisation factor;
    REQUIRE(factor.factor(A));
    const VectorXd ones = VectorXd::Ones(A.rows());
    VectorXd x = A * ones;
    factor.solve(x);
    CHECK(error(x, ones) < 1e-12);
    MatrixXd X = A * MatrixXd::Ones(A.rows(), 2);
    factor.by_substitution().solve(X);
    CHECK(error(X, MatrixXd::Ones(A.rows(), 2)) < 1e-12);
  }
  CachedFactorisation factor;
  CHECK_FALSE(factor.factor(path(33)));
}

TEST_CASE("Kept factors forget the matrix before, and give the same solution again to the last bit") {
  const SparseMatrix A = chain(20, 12), other = chain(20, 13);
  const VectorXd b = Random(14).vector(static_cast<int>(A.rows()));
  CachedFactorisation fresh, used;
  REQUIRE(fresh.factor(A));
  REQUIRE(used.factor(other));
  VectorXd x = b, y = b;
  used.solve(y);
  used = CachedFactorisation();
  REQUIRE(used.factor(A));
  y = b;
  fresh.solve(x);
  used.solve(y);
  CHECK(x == y);
}

}  // namespace flexarm::tests::cached_factorisation_test
