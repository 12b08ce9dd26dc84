#include "flexarm/eigen/eigenmodes.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <numbers>

#include "flexarm/errors.hpp"
#include "numerics.hpp"

namespace flexarm::tests::eigenmodes_test {

using flexarm::NotConverged;
using flexarm::eigen::Eigenmodes;
using flexarm::eigen::eigenmodes;
using SparseMatrix = Eigen::SparseMatrix<double>;
using std::numbers::pi;

namespace {

/// n masses of 2 kg in a row, springs of 5000 N/m between neighbours; both ends free.
struct Chain {
  SparseMatrix K, M, none;
  explicit Chain(int n) : K(n, n), M(n, n), none(n, n) {
    const double k = 5000;
    for (int i = 0; i + 1 < n; ++i) {
      K.coeffRef(i, i) += k;
      K.coeffRef(i + 1, i + 1) += k;
      K.coeffRef(i, i + 1) -= k;
      K.coeffRef(i + 1, i) -= k;
    }
    for (int i = 0; i < n; ++i) M.coeffRef(i, i) = 2;
    K.makeCompressed();
    M.makeCompressed();
  }
};

SparseMatrix holding(int n, std::vector<int> rows) {
  SparseMatrix J(static_cast<int>(rows.size()), n);
  for (int k = 0; k < static_cast<int>(rows.size()); ++k) J.insert(k, rows[static_cast<std::size_t>(k)]) = 1;
  J.makeCompressed();
  return J;
}

}  // namespace

TEST_CASE("A chain held at both ends has ω = 2 √(k/m) sin(k π/(2 n + 2))") {
  const int n = 22;
  const Chain chain(n);
  const Eigenmodes found = eigenmodes(chain.K, chain.none, chain.M, holding(n, {0, n - 1}), 5);
  REQUIRE(found.omega_squared.size() == 5);
  for (int k = 1; k <= 5; ++k) {
    const double omega = 2 * std::sqrt(5000.0 / 2) * std::sin(k * pi / (2 * (n - 1)));
    CHECK(std::sqrt(found.omega_squared[k - 1]) == near(omega, 1e-9));
  }
  const MatrixXd unit = found.shapes.transpose() * chain.M * found.shapes;
  CHECK(error(unit, MatrixXd::Identity(5, 5)) < 1e-8);  // orthogonal, of unit modal mass
  CHECK(largest(found.shapes.row(0)) < 1e-12);          // on the constraints
  CHECK(found.damped.size() == 0);
}

TEST_CASE("A free chain has its rigid motion first, at frequency zero") {
  const int n = 12;
  const Chain chain(n);
  const Eigenmodes found = eigenmodes(chain.K, chain.none, chain.M, SparseMatrix(0, n), 3);
  CHECK(std::abs(found.omega_squared[0]) < 1e-8);
  CHECK(found.shapes.col(0).maxCoeff() == near(found.shapes.col(0).minCoeff()));
  CHECK(std::sqrt(found.omega_squared[1]) == near(2 * std::sqrt(2500.0) * std::sin(pi / (2 * n)), 1e-9));
}

TEST_CASE("More modes than motions are not invented") {
  const Chain chain(5);
  CHECK(eigenmodes(chain.K, chain.none, chain.M, holding(5, {0, 1}), 10).omega_squared.size() == 3);
  CHECK(eigenmodes(chain.K, chain.none, chain.M, holding(5, {0, 1, 2, 3, 4}), 2).omega_squared.size() == 0);
}

TEST_CASE("Damping proportional to mass and stiffness gives ζ = (a/ω + b ω)/2") {
  const int n = 15;
  const Chain chain(n);
  const SparseMatrix C = 0.3 * chain.M + 2e-4 * chain.K;
  const Eigenmodes found = eigenmodes(chain.K, C, chain.M, holding(n, {0}), 4);
  REQUIRE(found.damped.size() == 4);
  for (int k = 0; k < 4; ++k) {
    const double omega = std::sqrt(found.omega_squared[k]);
    const double zeta = 0.5 * (0.3 / omega + 2e-4 * omega);
    CHECK(-found.damped[k].real() / std::abs(found.damped[k]) == near(zeta, 1e-8));
    CHECK(std::abs(found.damped[k]) == near(omega, 1e-8));
  }
}

TEST_CASE("A strong damper at one place solves the quadratic eigenvalue problem, not a modal guess") {
  const int n = 6;
  const Chain chain(n);
  SparseMatrix C(n, n);
  C.insert(n - 1, n - 1) = 60;  // ζ above 0.1, and modes that couple
  C.makeCompressed();
  const Eigenmodes found = eigenmodes(chain.K, C, chain.M, holding(n, {0}), 3);
  // The full first-order form, constraint eliminated.
  const int m = n - 1;
  MatrixXd A = MatrixXd::Zero(2 * m, 2 * m);
  A.topRightCorner(m, m).setIdentity();
  A.bottomLeftCorner(m, m) = -MatrixXd(chain.K).bottomRightCorner(m, m) / 2;
  A.bottomRightCorner(m, m) = -MatrixXd(C).bottomRightCorner(m, m) / 2;
  const Eigen::VectorXcd all = Eigen::EigenSolver<MatrixXd>(A).eigenvalues();
  for (int k = 0; k < 3; ++k) {
    CAPTURE(found.damped[k]);
    CHECK((all.array() - found.damped[k]).abs().minCoeff() < 1e-9 * std::abs(found.damped[k]));
  }
}

TEST_CASE("A negative stiffness shows as a negative ω²") {
  const int n = 4;
  const Chain chain(n);
  SparseMatrix K = chain.K;
  K.coeffRef(0, 0) -= 4;
  const Eigenmodes found = eigenmodes(K, chain.none, chain.M, SparseMatrix(0, n), 1);
  const double lowest = Eigen::SelfAdjointEigenSolver<MatrixXd>(MatrixXd(K) / 2).eigenvalues()[0];
  CHECK(lowest < -0.4);
  CHECK(found.omega_squared[0] == near(lowest, 1e-8));
}

TEST_CASE("a motion without mass adds no mode, in systems small enough for the dense solution") {
  // A spring of 5000 N/m hangs a massless point between the ground and, by another, a mass of 2 kg: k/2 holds
  // it.
  SparseMatrix K(2, 2), M(2, 2), none(2, 2);
  K.coeffRef(0, 0) = 10000;
  K.coeffRef(1, 1) = 5000;
  K.coeffRef(0, 1) = K.coeffRef(1, 0) = -5000;
  M.coeffRef(1, 1) = 2;
  const Eigenmodes modes = eigenmodes(K, none, M, SparseMatrix(0, 2), 5);
  REQUIRE(modes.omega_squared.size() == 1);
  CHECK(modes.omega_squared[0] == near(2500.0 / 2, 1e-9 * 1250));
}

TEST_CASE("modes about an unstable equilibrium are refused") {
  Chain chain(5);
  chain.K.coeffRef(0, 0) -= 50000;
  CHECK_THROWS_AS(eigenmodes(chain.K, chain.none, chain.M, SparseMatrix(0, 5), 2), NotConverged);
}

TEST_CASE("Motions without any mass have no modes, damped or not") {
  Eigen::SparseMatrix<double> K(2, 2), C(2, 2), M(2, 2), J(0, 2);
  for (int k = 0; k < 2; ++k) K.insert(k, k) = C.insert(k, k) = 1;
  CHECK(flexarm::eigen::eigenmodes(K, C, M, J, 2).omega_squared.size() == 0);
}

TEST_CASE("An eigenvalue problem whose numbers overflow fails, damped or not") {
  Eigen::SparseMatrix<double> K(2, 2), C(2, 2), M(2, 2), J(0, 2);
  M.setIdentity();
  for (int k = 0; k < 2; ++k) K.insert(k, k) = 1e4, C.insert(k, k) = 1;
  CHECK(flexarm::eigen::eigenmodes(K, C, M, J, 2).damped.size() == 2);
  for (const double bad : {HUGE_VAL, std::nan("")}) {
    C.coeffRef(0, 0) = bad;
    CHECK_THROWS_AS(flexarm::eigen::eigenmodes(K, C, M, J, 2), flexarm::NotConverged);
    C.coeffRef(0, 0) = 1;
    K.coeffRef(1, 1) = bad;
    CHECK_THROWS_AS(flexarm::eigen::eigenmodes(K, C, M, J, 2), flexarm::NotConverged);
    K.coeffRef(1, 1) = 1e4;
  }
}

}  // namespace flexarm::tests::eigenmodes_test
