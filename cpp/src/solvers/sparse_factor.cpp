#include "flexarm/solvers/sparse_factor.hpp"

#include <cmath>

#ifdef FLEXARM_HAS_KLU
#include <klu.h>

#include <algorithm>
#include <vector>
#else
#include <Eigen/SparseLU>
#endif

namespace flexarm::solvers {

#ifdef FLEXARM_HAS_KLU

namespace {
// Below this estimate of 1/condition the solution has no digits left.
constexpr double singular_rcond = 1e-18;

/// KLU's factors in the open, L U + F = R⁻¹ P A Q with U's diagonal last in its columns and L's first, of one
/// diagonal block after the other; F is what lies beside the blocks.
struct Triangles {
  struct Part {
    std::vector<int> start, row;
    std::vector<double> value;

    void resize(int n, int entries) {
      start.resize(n + 1);
      row.resize(entries);
      value.resize(entries);
    }
  };
  Part L, U, F;
  std::vector<int> P, Q, blocks;
  std::vector<double> scale;
  SparseFactor::Rows x;
  bool current = false;

  void take(klu_symbolic* symbolic, klu_numeric* numeric, klu_common* common) {
    const int n = symbolic->n;
    L.resize(n, numeric->lnz);
    U.resize(n, numeric->unz);
    F.resize(n, std::max(1, numeric->nzoff));
    P.resize(n);
    Q.resize(n);
    blocks.resize(n + 1);
    scale.assign(n, 1.0);
    klu_extract(numeric, symbolic, L.start.data(), L.row.data(), L.value.data(), U.start.data(), U.row.data(),
                U.value.data(), F.start.data(), F.row.data(), F.value.data(), P.data(), Q.data(),
                scale.data(), blocks.data(), common);
    n_blocks = symbolic->nblocks;
    current = true;
  }

  void solve(SparseFactor::Rows& X) {
    const auto n = static_cast<int>(P.size());
    x.resize(n, X.cols());
    for (int k = 0; k < n; ++k) x.row(k) = 1 / scale[k] * X.row(P[k]);
    for (int block = n_blocks - 1; block >= 0; --block) {
      const int first = blocks[block], last = blocks[block + 1];
      for (int k = first; k < last; ++k) subtract(L, k, L.start[k] + 1, L.start[k + 1]);
      for (int k = last - 1; k >= first; --k) {
        const int diagonal = U.start[k + 1] - 1;
        x.row(k) *= 1 / U.value[diagonal];
        subtract(U, k, U.start[k], diagonal);
      }
      for (int k = first; k < last; ++k) subtract(F, k, F.start[k], F.start[k + 1]);
    }
    for (int k = 0; k < n; ++k) X.row(Q[k]) = x.row(k);
  }

 private:
  /// Takes column k of a factor, times the solution's k-th row, from the rows below or above.
  void subtract(const Part& part, int k, int begin, int end) {
    const Eigen::Index m = x.cols();
    const double* known = x.data() + k * m;
    for (int p = begin; p < end; ++p) {
      double* row = x.data() + part.row[p] * m;
      const double factor = part.value[p];
      for (Eigen::Index j = 0; j < m; ++j) row[j] -= factor * known[j];
    }
  }

  int n_blocks = 0;
};

}  // namespace

struct SparseFactor::Backend {
  klu_common common;
  klu_symbolic* symbolic = nullptr;
  klu_numeric* numeric = nullptr;

  Backend() { klu_defaults(&common); }
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;
  ~Backend() {
    klu_free_numeric(&numeric, &common);
    klu_free_symbolic(&symbolic, &common);
  }

  bool factor(const Eigen::SparseMatrix<double>& A) {
    triangles.current = false;
    auto* columns = const_cast<int*>(A.outerIndexPtr());
    auto* rows = const_cast<int*>(A.innerIndexPtr());
    auto* values = const_cast<double*>(A.valuePtr());
    if (symbolic == nullptr) symbolic = klu_analyze(static_cast<int>(A.rows()), columns, rows, &common);
    if (symbolic == nullptr) return false;
    if (numeric != nullptr && klu_refactor(columns, rows, values, symbolic, numeric, &common) == 1 &&
        healthy(columns, rows, values)) {
      return true;
    }
    klu_free_numeric(&numeric, &common);
    numeric = klu_factor(columns, rows, values, symbolic, &common);
    return numeric != nullptr && well_conditioned();
  }

  bool well_conditioned() {
    return klu_rcond(symbolic, numeric, &common) == 1 && std::isfinite(common.rcond) &&
           common.rcond > singular_rcond;
  }

  /// Old pivots serve new numbers as long as the factors do not grow.
  bool healthy(int* columns, int* rows, double* values) {
    if (!well_conditioned()) return false;
    return klu_rgrowth(columns, rows, values, symbolic, numeric, &common) == 1 && common.rgrowth > 1e-8;
  }

  void solve(double* x, int n, int n_rhs) { klu_solve(symbolic, numeric, n, n_rhs, x, &common); }

  void solve(Rows& X) {
    if (!triangles.current) triangles.take(symbolic, numeric, &common);
    triangles.solve(X);
  }

  Triangles triangles;
};

const char* SparseFactor::backend() { return "KLU"; }

#else

struct SparseFactor::Backend {
  Eigen::SparseLU<Eigen::SparseMatrix<double>, Eigen::COLAMDOrdering<int>> lu;
  bool analysed = false;

  bool factor(const Eigen::SparseMatrix<double>& A) {
    if (!analysed) lu.analyzePattern(A);
    analysed = true;
    lu.factorize(A);
    return lu.info() == Eigen::Success;
  }

  void solve(double* x, int n, int n_rhs) {
    Eigen::Map<Eigen::MatrixXd> X(x, n, n_rhs);
    X = lu.solve(X).eval();
  }

  void solve(Rows& X) { X = lu.solve(Eigen::MatrixXd(X)).eval(); }
};

const char* SparseFactor::backend() { return "Eigen SparseLU"; }

#endif

SparseFactor::SparseFactor() : backend_(std::make_unique<Backend>()) {}
SparseFactor::~SparseFactor() = default;
SparseFactor::SparseFactor(SparseFactor&&) noexcept = default;
SparseFactor& SparseFactor::operator=(SparseFactor&&) noexcept = default;

bool SparseFactor::factor(const Eigen::SparseMatrix<double>& matrix) {
  ++factorisations_;
  if (matrix.nonZeros() != entries_) backend_ = std::make_unique<Backend>();  // another pattern
  entries_ = matrix.nonZeros();
  return backend_->factor(matrix);
}

void SparseFactor::solve(Eigen::Ref<Eigen::VectorXd> x) const {
  backend_->solve(x.data(), static_cast<int>(x.size()), 1);
}

void SparseFactor::solve(Eigen::MatrixXd& X) const {
  backend_->solve(X.data(), static_cast<int>(X.rows()), static_cast<int>(X.cols()));
}

void SparseFactor::solve(Rows& X) const { backend_->solve(X); }

}  // namespace flexarm::solvers
