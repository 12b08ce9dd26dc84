#include "flexarm/linear_solvers/sparse_factor.hpp"

#include <cmath>

#ifdef FLEXARM_HAS_KLU
#include <klu.h>

#include <algorithm>

#include "flexarm/linear_solvers/triangular_factors.hpp"
#else
#include <Eigen/SparseLU>
#endif

namespace flexarm::linear_solvers {

#ifdef FLEXARM_HAS_KLU

namespace {
// Below this estimate of 1/condition the solution has no digits left.
constexpr double singular_rcond = 1e-18;

/// KLU's factors in the open.
void extract(klu_symbolic* symbolic, klu_numeric* numeric, klu_common* common, TriangularFactors& to) {
  to.resize(symbolic->n, numeric->lnz, numeric->unz, std::max(1, numeric->nzoff), symbolic->nblocks);
  klu_extract(numeric, symbolic, to.L.start.data(), to.L.row.data(), to.L.value.data(), to.U.start.data(),
              to.U.row.data(), to.U.value.data(), to.F.start.data(), to.F.row.data(), to.F.value.data(),
              to.P.data(), to.Q.data(), to.scale.data(), to.blocks.data(), common);
}

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
    if (in_the_open && triangles.refactor(A)) return true;
    in_the_open = false;
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

  void solve(double* x, int n, int n_rhs) {
    if (!in_the_open) {
      klu_solve(symbolic, numeric, n, n_rhs, x, &common);
      return;
    }
    for (int k = 0; k < n_rhs; ++k) triangles.solve(x + k * n, 1);
  }

  void solve(Rows& X) {
    if (!in_the_open) extract(symbolic, numeric, &common, triangles);
    in_the_open = true;
    triangles.solve(X.data(), X.cols());
  }

  TriangularFactors triangles;
  bool in_the_open = false;  // from the first solution by rows on they are made there
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
  if (!std::isfinite(matrix.coeffs().sum())) return false;                    // as is the sum of what is not
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

}  // namespace flexarm::linear_solvers
