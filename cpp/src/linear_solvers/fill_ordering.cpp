#include "flexarm/linear_solvers/fill_ordering.hpp"

#ifdef FLEXARM_HAS_CHOLMOD

#include <cholmod.h>

#include <new>
#include <stdexcept>

#include "flexarm/errors.hpp"
#include "flexarm/linear_solvers/blas_info.hpp"

namespace flexarm::linear_solvers {
namespace {

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
  explicit Common(int how = CHOLMOD_SIMPLICIAL) {
    cholmod_start(this);
    print = 0;
    error_handler = nullptr;
    supernodal = how;
  }
  Common(const Common&) = delete;
  Common& operator=(const Common&) = delete;
  ~Common() { cholmod_finish(this); }
};

/// Whether a matrix of one entry can be analysed that way: parts that a library lacks fail at once.
bool can_analyse(int supernodal, int ordering) {
  Common common(supernodal);
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

void check(const Common& common) {
  if (common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
  if (common.status == CHOLMOD_TOO_LARGE)
    throw InvalidParameter("the matrix is too large for CHOLMOD with 32-bit indices");
  if (common.status < CHOLMOD_OK)
    throw std::runtime_error("CHOLMOD failed with status " + std::to_string(common.status));
}

}  // namespace

FillOrdering fill_ordering(const LowerTriangle& pattern) {
  survive_forks();
  Common common;
  common.method[0].ordering = CHOLMOD_AMD;
  common.method[1].ordering = CHOLMOD_METIS;
  common.nmethods = has_metis() ? 2 : 1;
  cholmod_sparse S = view(pattern);
  cholmod_factor* L = cholmod_analyze(&S, &common);
  check(common);
  FillOrdering found;
  const auto* order = static_cast<const int*>(L->Perm);
  found.order.assign(order, order + L->n);
  found.metis = L->ordering == CHOLMOD_METIS;
  found.entries_amd = common.method[0].lnz;
  found.entries_metis = has_metis() ? common.method[1].lnz : 0;
  cholmod_free_factor(&L, &common);
  return found;
}

bool has_gpl_parts() {
  static const bool has = can_analyse(CHOLMOD_SUPERNODAL, CHOLMOD_AMD);
  return has;
}

bool has_metis() {
  static const bool has = can_analyse(CHOLMOD_SIMPLICIAL, CHOLMOD_METIS);
  return has;
}

}  // namespace flexarm::linear_solvers

#else

#include <Eigen/OrderingMethods>

namespace flexarm::linear_solvers {

FillOrdering fill_ordering(const LowerTriangle& pattern) {
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> inverse;
  Eigen::AMDOrdering<int>()(Eigen::SparseMatrix<double>(pattern).selfadjointView<Eigen::Lower>(), inverse);
  const auto& order = inverse.indices();
  return {std::vector<int>(order.begin(), order.end())};
}

bool has_gpl_parts() { return false; }
bool has_metis() { return false; }

}  // namespace flexarm::linear_solvers

#endif
