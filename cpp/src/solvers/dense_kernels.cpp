#include "flexarm/solvers/dense_kernels.hpp"

#include <Eigen/Core>

#include "flexarm/solvers/blas_info.hpp"

namespace flexarm::solvers {
namespace {

template <class Scalar>
using Gemm = void(const char*, const char*, const int*, const int*, const int*, const Scalar*, const Scalar*,
                  const int*, const Scalar*, const int*, const Scalar*, Scalar*, const int*);
template <class Scalar>
using Syrk = void(const char*, const char*, const int*, const int*, const Scalar*, const Scalar*, const int*,
                  const Scalar*, Scalar*, const int*);
template <class Scalar>
using Trsm = void(const char*, const char*, const char*, const char*, const int*, const int*, const Scalar*,
                  const Scalar*, const int*, Scalar*, const int*);

/// The functions of one precision; all null where one is missing.
template <class Scalar>
struct Blas {
  Gemm<Scalar>* gemm = find<Gemm<Scalar>>("gemm_");
  Syrk<Scalar>* syrk = find<Syrk<Scalar>>("syrk_");
  Trsm<Scalar>* trsm = find<Trsm<Scalar>>("trsm_");

  static const Blas& loaded() {
    static const Blas blas;
    return blas;
  }

 private:
  template <class Function>
  static Function* find(const std::string& name) {
    return reinterpret_cast<Function*>(blas_symbol((sizeof(Scalar) == 8 ? "d" : "s") + name));
  }
};

template <class Scalar>
auto map(Panel<Scalar> A, std::ptrdiff_t rows, std::ptrdiff_t columns) {
  using Plain = Eigen::Matrix<std::remove_const_t<Scalar>, Eigen::Dynamic, Eigen::Dynamic>;
  using Matrix = std::conditional_t<std::is_const_v<Scalar>, const Plain, Plain>;
  return Eigen::Map<Matrix, 0, Eigen::OuterStride<>>(A.data, rows, columns, Eigen::OuterStride<>(A.stride));
}

template <class Scalar>
int stride(Panel<Scalar> A, int least) {
  return std::max(static_cast<int>(A.stride), std::max(1, least));
}

const char* letter(Transposed t) { return t == Transposed::yes ? "T" : "N"; }

}  // namespace

template <class Scalar>
void add_product(Transposed a, Transposed b, int m, int n, int k, Scalar factor, Panel<const Scalar> A,
                 Panel<const Scalar> B, Panel<Scalar> C) {
  if (m == 0 || n == 0 || k == 0) return;
  if (auto* gemm = Blas<Scalar>::loaded().gemm) {
    const Scalar one = 1;
    const int lda = stride(A, a == Transposed::yes ? k : m), ldb = stride(B, b == Transposed::yes ? n : k),
              ldc = stride(C, m);
    gemm(letter(a), letter(b), &m, &n, &k, &factor, A.data, &lda, B.data, &ldb, &one, C.data, &ldc);
    return;
  }
  auto sum = map(C, m, n);
  if (a == Transposed::yes && b == Transposed::yes)
    sum.noalias() += factor * map(A, k, m).transpose() * map(B, n, k).transpose();
  else if (a == Transposed::yes)
    sum.noalias() += factor * map(A, k, m).transpose() * map(B, k, n);
  else if (b == Transposed::yes)
    sum.noalias() += factor * map(A, m, k) * map(B, n, k).transpose();
  else
    sum.noalias() += factor * map(A, m, k) * map(B, k, n);
}

template <class Scalar>
void subtract_square(int n, int k, Panel<const Scalar> A, Panel<Scalar> C) {
  if (n == 0 || k == 0) return;
  if (auto* syrk = Blas<Scalar>::loaded().syrk) {
    const Scalar factor = -1, one = 1;
    const int lda = stride(A, n), ldc = stride(C, n);
    syrk("L", "N", &n, &k, &factor, A.data, &lda, &one, C.data, &ldc);
    return;
  }
  map(C, n, n).template selfadjointView<Eigen::Lower>().rankUpdate(map(A, n, k), Scalar(-1));
}

template <class Scalar>
void solve_right(Transposed l, int m, int n, Panel<const Scalar> L, Panel<Scalar> X) {
  if (m == 0 || n == 0) return;
  if (auto* trsm = Blas<Scalar>::loaded().trsm) {
    const Scalar one = 1;
    const int ldl = stride(L, n), ldx = stride(X, m);
    trsm("R", "L", letter(l), "N", &m, &n, &one, L.data, &ldl, X.data, &ldx);
    return;
  }
  auto x = map(X, m, n);
  const auto lower = map(L, n, n);
  if (l == Transposed::yes)
    lower.transpose().template triangularView<Eigen::Upper>().template solveInPlace<Eigen::OnTheRight>(x);
  else
    lower.template triangularView<Eigen::Lower>().template solveInPlace<Eigen::OnTheRight>(x);
}

#define FLEXARM_KERNELS(Scalar)                                                                 \
  template void add_product(Transposed, Transposed, int, int, int, Scalar, Panel<const Scalar>, \
                            Panel<const Scalar>, Panel<Scalar>);                                \
  template void subtract_square(int, int, Panel<const Scalar>, Panel<Scalar>);                  \
  template void solve_right(Transposed, int, int, Panel<const Scalar>, Panel<Scalar>);
FLEXARM_KERNELS(double)
FLEXARM_KERNELS(float)
#undef FLEXARM_KERNELS

}  // namespace flexarm::solvers
