#include "flexarm/solvers/cholesky_factor.hpp"

#ifdef FLEXARM_HAS_CHOLMOD

#include <cholmod.h>

#include <algorithm>
#include <chrono>
#include <new>

#include "flexarm/interrupt.hpp"
#include "flexarm/solvers/blas_info.hpp"

namespace flexarm::solvers {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Columns solved at once: the factor is read once for all of them. Beyond 32 the gain is small.
constexpr Index block_columns = 32;

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// CHOLMOD's view of a matrix that stays where it is.
cholmod_sparse view(const LowerTriangle& A) {
  cholmod_sparse S{};
  S.nrow = S.ncol = static_cast<std::size_t>(A.rows());
  S.nzmax = static_cast<std::size_t>(A.nonZeros());
  S.p = const_cast<int*>(A.outerIndexPtr());
  S.i = const_cast<int*>(A.innerIndexPtr());
  S.x = const_cast<double*>(A.valuePtr());
  S.stype = -1;  // lower triangle
  S.itype = CHOLMOD_INT;
  S.xtype = CHOLMOD_REAL;
  S.dtype = CHOLMOD_DOUBLE;
  S.sorted = S.packed = 1;
  return S;
}

/// One workspace of CHOLMOD, silent: its failures come out as exceptions.
struct Common : cholmod_common {
  Common() {
    cholmod_start(this);
    print = 0;
    error_handler = nullptr;
  }
  Common(const Common&) = delete;
  Common& operator=(const Common&) = delete;
  ~Common() { cholmod_finish(this); }
};

/// Whether a matrix of one entry can be analysed that way: parts that a library lacks fail at once.
bool can_analyse(int supernodal, int ordering) {
  Common common;
  common.supernodal = supernodal;
  common.nmethods = 1;
  common.method[0].ordering = ordering;
  cholmod_sparse* one = cholmod_speye(1, 1, CHOLMOD_REAL, &common);
  one->stype = -1;
  cholmod_factor* L = cholmod_analyze(one, &common);
  const bool can = common.status == CHOLMOD_OK && L != nullptr &&
                   (supernodal != CHOLMOD_SUPERNODAL || L->is_super != 0) && L->ordering == ordering;
  cholmod_free_factor(&L, &common);
  cholmod_free_sparse(&one, &common);
  return can;
}

/// The pivots as parts of the diagonal of A, in the order of elimination: L_jj²/A_jj.
class Pivots {
 public:
  Pivots(const LowerTriangle& A, const cholmod_factor& L)
      : order_(static_cast<const int*>(L.Perm)), diagonal_(diagonal(A)), worst_column_(order_[0]) {
    L.is_super != 0 ? scan_supernodes(L) : scan_columns(L);
  }
  double worst() const { return worst_; }
  Index worst_column() const { return worst_column_; }

 private:
  void note(Index j, double L_jj) {
    const double part = L_jj * L_jj / diagonal_[order_[j]];
    if (part >= worst_) return;
    worst_ = part;
    worst_column_ = order_[j];
  }
  void scan_columns(const cholmod_factor& L) {
    const auto* p = static_cast<const int*>(L.p);
    const auto* x = static_cast<const double*>(L.x);
    for (std::size_t j = 0; j < L.n; ++j) note(static_cast<Index>(j), x[p[j]]);
  }
  void scan_supernodes(const cholmod_factor& L) {
    const auto *first = static_cast<const int*>(L.super), *rows = static_cast<const int*>(L.pi),
               *start = static_cast<const int*>(L.px);
    const auto* x = static_cast<const double*>(L.x);
    for (std::size_t s = 0; s < L.nsuper; ++s) {
      const Index height = rows[s + 1] - rows[s];
      for (Index j = first[s]; j < first[s + 1]; ++j) note(j, x[start[s] + (j - first[s]) * (height + 1)]);
    }
  }

  const int* order_;
  Eigen::VectorXd diagonal_;
  double worst_ = 1;
  Index worst_column_;
};

[[noreturn]] void fail(Index column) {
  throw NotPositiveDefinite(
      "a symmetric matrix must be positive definite, row " + std::to_string(column) + " is not", column);
}

}  // namespace

struct CholeskyFactor::Backend {
  Common common;
  cholmod_factor* L = nullptr;
  cholmod_dense *X = nullptr, *Y = nullptr, *E = nullptr;  // kept from one solve to the next

  Backend() = default;
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;
  ~Backend() {
    cholmod_free_dense(&X, &common);
    cholmod_free_dense(&Y, &common);
    cholmod_free_dense(&E, &common);
    cholmod_free_factor(&L, &common);
  }

  /// AMD and METIS both: together they cost a tenth of the factorisation, and METIS saves half of it or more.
  void analyse(cholmod_sparse& S, CholeskyReport& report) {
    const double start = seconds();
    common.supernodal = has_supernodal() ? CHOLMOD_SUPERNODAL : CHOLMOD_SIMPLICIAL;
    common.final_ll = 1;  // L Lᵀ in the simplicial case too, where L D Lᵀ would pass indefinite matrices
    common.method[0].ordering = CHOLMOD_AMD;
    common.method[1].ordering = CHOLMOD_METIS;
    common.nmethods = has_metis() ? 2 : 1;
    L = cholmod_analyze(&S, &common);
    check();
    report.backend = L->is_super != 0 ? "CHOLMOD supernodal" : "CHOLMOD simplicial";
    report.ordering = L->ordering == CHOLMOD_METIS ? "METIS" : "AMD";
    report.entries_amd = common.method[0].lnz;
    report.entries_metis = has_metis() ? common.method[1].lnz : 0;
    report.entries = common.method[common.selected].lnz;
    report.operations = common.method[common.selected].fl;
    report.seconds_ordering = seconds() - start;
  }

  void factor(cholmod_sparse& S, const LowerTriangle& A, CholeskyReport& report) {
    const double start = seconds();
    cholmod_factorize(&S, L, &common);
    if (common.status == CHOLMOD_NOT_POSDEF) fail(static_cast<const int*>(L->Perm)[L->minor]);
    check();
    const Pivots pivots(A, *L);
    if (!(pivots.worst() > smallest_pivot)) fail(pivots.worst_column());
    report.seconds_factor = seconds() - start;
  }

  void check() const {
    if (common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    if (common.status == CHOLMOD_TOO_LARGE)
      throw InvalidParameter("the matrix is too large for CHOLMOD with 32-bit indices");
    if (common.status < CHOLMOD_OK)
      throw std::runtime_error("CHOLMOD failed with status " + std::to_string(common.status));
  }

  void solve(Eigen::Ref<MatrixXd> B) {
    cholmod_dense right{};
    right.nrow = static_cast<std::size_t>(B.rows());
    right.ncol = static_cast<std::size_t>(B.cols());
    right.d = static_cast<std::size_t>(B.outerStride());
    right.nzmax = right.d * right.ncol;
    right.x = B.data();
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    cholmod_solve2(CHOLMOD_A, L, &right, nullptr, &X, nullptr, &Y, &E, &common);
    check();
    B = Eigen::Map<const MatrixXd>(static_cast<const double*>(X->x), B.rows(), B.cols());
  }
};

CholeskyFactor::CholeskyFactor(const LowerTriangle& A) : backend_(std::make_unique<Backend>()) {
  report_.blas = loaded_blas();
  survive_forks();
  cholmod_sparse S = view(A);
  backend_->analyse(S, report_);
  check_interrupt();
  backend_->factor(S, A, report_);
}

void CholeskyFactor::solve(Eigen::Ref<MatrixXd> X) const {
  for (Index k = 0; k < X.cols(); k += block_columns) {
    check_interrupt();
    backend_->solve(X.middleCols(k, std::min(block_columns, X.cols() - k)));
  }
}

bool CholeskyFactor::has_supernodal() {
  static const bool has = can_analyse(CHOLMOD_SUPERNODAL, CHOLMOD_AMD);
  return has;
}

bool CholeskyFactor::has_metis() {
  static const bool has = can_analyse(CHOLMOD_SIMPLICIAL, CHOLMOD_METIS);
  return has;
}

CholeskyFactor::~CholeskyFactor() = default;
CholeskyFactor::CholeskyFactor(CholeskyFactor&&) noexcept = default;
CholeskyFactor& CholeskyFactor::operator=(CholeskyFactor&&) noexcept = default;

}  // namespace flexarm::solvers

#endif
