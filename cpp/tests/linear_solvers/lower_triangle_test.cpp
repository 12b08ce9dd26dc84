#include "flexarm/linear_solvers/lower_triangle.hpp"

#include <doctest/doctest.h>

#include "patterns.hpp"

namespace flexarm::tests::lower_triangle_test {

TEST_CASE("Products of any number of columns are those of the whole dense matrix") {
  Random random(31);
  for (int columns = 0; columns <= 35; ++columns) {
    CAPTURE(columns);
    const SparseMatrix A = random_matrix(random, 4);
    const VectorXd numbers = random.vector(A.rows() * columns);
    const MatrixXd X = Eigen::Map<const MatrixXd>(numbers.data(), A.rows(), columns);
    const MatrixXd product = flexarm::linear_solvers::multiply(A, X);
    REQUIRE(product.cols() == columns);
    CHECK(relative_error(product, full(A) * X) < 1e-14);
  }
}

}  // namespace flexarm::tests::lower_triangle_test
