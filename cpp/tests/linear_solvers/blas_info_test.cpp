#include "flexarm/linear_solvers/blas_info.hpp"

#include <doctest/doctest.h>

namespace flexarm::tests::blas_info_test {

using flexarm::linear_solvers::blas_symbol;
using flexarm::linear_solvers::OneBlasThread;

TEST_CASE("one thread is left to OpenBLAS for a while, and all return") {
  auto* const count = reinterpret_cast<int (*)()>(blas_symbol("openblas_get_num_threads"));
  auto* const set = reinterpret_cast<void (*)(int)>(blas_symbol("openblas_set_num_threads"));
  if (count == nullptr || set == nullptr) return;  // another BLAS, or none
  const int before = count();
  set(2);
  {
    const OneBlasThread outer, inner;
    CHECK(count() == 1);
  }
  CHECK(count() == 2);
  set(before);
}

}  // namespace flexarm::tests::blas_info_test
