#include "flexarm/number_rows.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "flexarm/errors.hpp"

namespace flexarm::tests::number_rows_test {

using flexarm::number_rows;

TEST_CASE("Cells between commas become numbers, the nearest that a double can hold") {
  const auto found = number_rows(" 1 ,x,+2.5e-3\n0.1,,-.5\n3,\"y\",0.30000000000000004", 3, {2, 0});
  REQUIRE(found);
  CHECK(*found == (flexarm::RowMatrix(3, 2) << 2.5e-3, 1, -0.5, 0.1, 0.1 + 0.2, 3).finished());
}

TEST_CASE("Empty cells and nan are no numbers, in every corner of a row") {
  const auto found = number_rows(",NaN\n nan ,\n\t,2", 2, {0, 1});
  REQUIRE(found);
  CHECK(found->array().isNaN().count() == 5);
  CHECK((*found)(2, 1) == 2);
}

TEST_CASE("Empty lines and comments are no rows") {
  const auto found = number_rows("\n# 1,2\n  # 3\n  \n4,5\n\n", 2, {1});
  REQUIRE(found);
  CHECK(*found == flexarm::RowMatrix::Constant(1, 1, 5));
  CHECK(number_rows("", 2, {0, 1})->rows() == 0);
}

TEST_CASE("A row of another length, or a cell that is no number, is refused") {
  for (const char* text : {"1", "1,2,3", "1,2,", "1,2 3", "1,1_000", "1,0x10", "1,+-2", "1,++2", "1,+", "1,-",
                           "1,1e", "1,nan(1)", "1,1e999", "1,\"2\"", "1,2 # late",
                           "1,\xC2\xA0"
                           "2"}) {
    CAPTURE(text);
    CHECK_FALSE(number_rows(text, 2, {0, 1}));
  }
  CHECK(number_rows("1,no number", 2, {0}));
}

TEST_CASE("A column that no row has is an error") {
  CHECK_THROWS_AS(number_rows("1,2", 2, {2}), flexarm::InvalidParameter);
  CHECK_THROWS_AS(number_rows("1,2", 2, {-1}), flexarm::InvalidParameter);
}

}  // namespace flexarm::tests::number_rows_test
