#include "flexarm/linear_solvers/dense_kernels.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <type_traits>

#include "flexarm/linear_solvers/blas_info.hpp"

namespace flexarm::linear_solvers {
namespace {

// Fortran passes the lengths of its strings after all other arguments.
using Length = std::size_t;
using Gemm = void(const char*, const char*, const int*, const int*, const int*, const double*, const double*,
                  const int*, const double*, const int*, const double*, double*, const int*, Length, Length);
using Syrk = void(const char*, const char*, const int*, const int*, const double*, const double*, const int*,
                  const double*, double*, const int*, Length, Length);
using Trsm = void(const char*, const char*, const char*, const char*, const int*, const int*, const double*,
                  const double*, const int*, double*, const int*, Length, Length, Length, Length);

/// Null where there is no BLAS.
struct Blas {
  Gemm* gemm = reinterpret_cast<Gemm*>(blas_symbol("dgemm_"));
  Syrk* syrk = reinterpret_cast<Syrk*>(blas_symbol("dsyrk_"));
  Trsm* trsm = reinterpret_cast<Trsm*>(blas_symbol("dtrsm_"));
};

const Blas& blas() {
  static const Blas loaded;
  return loaded;
}

template <class Entry>
auto map(MatrixView<Entry> A, std::ptrdiff_t rows, std::ptrdiff_t columns) {
  using Matrix = std::conditional_t<std::is_const_v<Entry>, const Eigen::MatrixXd, Eigen::MatrixXd>;
  return Eigen::Map<Matrix, 0, Eigen::OuterStride<>>(A.data, rows, columns, Eigen::OuterStride<>(A.stride));
}

/// BLAS refuses a distance of columns below the number of rows, though there be one column only.
int stride(ConstPanel A, int rows) { return std::max({static_cast<int>(A.stride), 1, rows}); }

const char* letter(Transposed t) { return t == Transposed::yes ? "T" : "N"; }

}  // namespace

void add_product(Transposed a, Transposed b, int m, int n, int k, double factor, ConstPanel A, ConstPanel B,
                 Panel C) {
  if (m == 0 || n == 0 || k == 0) return;
  const bool at = a == Transposed::yes, bt = b == Transposed::yes;
  if (blas().gemm != nullptr) {
    const double one = 1;
    const int lda = stride(A, at ? k : m), ldb = stride(B, bt ? n : k), ldc = stride(C, m);
    blas().gemm(letter(a), letter(b), &m, &n, &k, &factor, A.data, &lda, B.data, &ldb, &one, C.data, &ldc, 1,
                1);
    return;
  }
  auto sum = map(C, m, n);
  if (at && bt)
    sum.noalias() += factor * map(A, k, m).transpose() * map(B, n, k).transpose();
  else if (at)
    sum.noalias() += factor * map(A, k, m).transpose() * map(B, k, n);
  else if (bt)
    sum.noalias() += factor * map(A, m, k) * map(B, n, k).transpose();
  else
    sum.noalias() += factor * map(A, m, k) * map(B, k, n);
}

void subtract_square(int n, int k, ConstPanel A, Panel C) {
  if (n == 0 || k == 0) return;
  if (blas().syrk != nullptr) {
    const double factor = -1, one = 1;
    const int lda = stride(A, n), ldc = stride(C, n);
    blas().syrk("L", "N", &n, &k, &factor, A.data, &lda, &one, C.data, &ldc, 1, 1);
    return;
  }
  map(C, n, n).selfadjointView<Eigen::Lower>().rankUpdate(map(A, n, k), -1.0);
}

void solve_right(int m, int n, ConstPanel L, Panel X) {
  if (m == 0 || n == 0) return;
  if (blas().trsm != nullptr) {
    const double one = 1;
    const int ldl = stride(L, n), ldx = stride(X, m);
    blas().trsm("R", "L", "T", "N", &m, &n, &one, L.data, &ldl, X.data, &ldx, 1, 1, 1, 1);
    return;
  }
  auto x = map(X, m, n);
  map(L, n, n).transpose().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(x);
}

}  // namespace flexarm::linear_solvers
