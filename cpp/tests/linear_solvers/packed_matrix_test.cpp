#include "flexarm/linear_solvers/packed_matrix.hpp"

#include <doctest/doctest.h>

namespace flexarm::tests::packed_matrix_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using flexarm::linear_solvers::PackedMatrix;

TEST_CASE("sums have the bits of a plain loop in the order of columns") {
  std::srand(11);
  for (const Index rows : {1, 3, 4, 7, 16, 19, 20, 24, 25, 31, 48, 61}) {
    for (const Index cols : {0, 1, 2, 19, 33}) {
      const MatrixXd A = MatrixXd::Random(rows, cols);
      const VectorXd x = VectorXd::Random(cols);
      const PackedMatrix packed(A);
      VectorXd y = VectorXd::Constant(packed.filled_rows(), 7);
      packed.multiply(x.data(), y.data());
      for (Index i = 0; i < rows; ++i) {
        volatile double sum = 0;  // rounded after every operation
        for (Index j = 0; j < cols; ++j) {
          const volatile double product = A(i, j) * x[j];
          sum = sum + product;
        }
        CHECK(y[i] == sum);
      }
      CHECK((y.tail(packed.filled_rows() - rows).array() == 0).all());
    }
  }
}

TEST_CASE("rows are filled up to a multiple of four") {
  CHECK(PackedMatrix(MatrixXd(5, 2)).filled_rows() == 8);
  CHECK(PackedMatrix(MatrixXd(8, 2)).filled_rows() == 8);
  CHECK(PackedMatrix(MatrixXd(0, 0)).filled_rows() == 0);
}

}  // namespace flexarm::tests::packed_matrix_test
