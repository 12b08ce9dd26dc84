#include "flexarm/dense.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>

namespace flexarm::tests::dense_test {

namespace {

/// Two equal columns but for a part of 1e-6, and a third one across.
Eigen::MatrixXd nearly_dependent() {
  Eigen::MatrixXd A(3, 3);
  A << 1, 1, 0,    //
      0, 1e-6, 0,  //
      0, 0, 2;
  return A;
}

}  // namespace

TEST_CASE("A pivot below the tolerance counts as zero") {
  CHECK(dense::rank(nearly_dependent(), 1e-8) == 3);
  CHECK(dense::rank(nearly_dependent(), 1e-4) == 2);
  CHECK(dense::rank(Eigen::MatrixXd::Zero(3, 2), 1e-8) == 0);
}

TEST_CASE("The shortest solution shares a load between equal columns, the exact one does not") {
  const Eigen::MatrixXd b = Eigen::Vector3d(1, 1e-6, 4);
  const Eigen::MatrixXd exact = dense::least_squares(nearly_dependent(), b);
  CHECK((exact - Eigen::Vector3d(0, 1, 2)).norm() < 1e-9);
  const Eigen::MatrixXd shortest = dense::least_squares(nearly_dependent(), b, 1e-4);
  CHECK((shortest - Eigen::Vector3d(0.5, 0.5, 2)).norm() < 1e-5);
}

TEST_CASE("Of unequal demands the least squares are the mean") {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Ones(4, 1), b = Eigen::Vector4d(1, 2, 3, 6);
  CHECK(dense::least_squares(A, b)(0, 0) == doctest::Approx(3));
}

}  // namespace flexarm::tests::dense_test
