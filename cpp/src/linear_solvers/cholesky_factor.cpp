#include "flexarm/linear_solvers/cholesky_factor.hpp"

#include <chrono>

#include "flexarm/linear_solvers/blas_info.hpp"
#include "flexarm/linear_solvers/supernodal_factor.hpp"

namespace flexarm::linear_solvers {
namespace {

using Eigen::MatrixXd;

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

struct CholeskyFactor::Backend {
  Supernodes nodes;
  std::unique_ptr<const SupernodalFactor> L;
};

CholeskyFactor::CholeskyFactor(const LowerTriangle& A) : backend_(std::make_unique<Backend>()) {
  const double start = seconds();
  Supernodes& nodes = backend_->nodes;
  nodes = supernodes(A);
  const double ordered = seconds();
  backend_->L = std::make_unique<SupernodalFactor>(A, nodes);
  const LeastPivot& least = backend_->L->least_pivot();
  if (!(least.part > smallest_pivot))
    throw NotPositiveDefinite(
        "a symmetric matrix must be positive definite, row " + std::to_string(least.column) + " is not",
        least.column);
  report_.backend = "supernodal";
  report_.ordering = nodes.found.metis ? "METIS" : "AMD";
  report_.blas = loaded_blas();
  report_.entries = nodes.entries;
  report_.entries_amd = nodes.found.entries_amd;
  report_.entries_metis = nodes.found.entries_metis;
  report_.operations = nodes.operations;
  report_.seconds_ordering = ordered - start;
  report_.seconds_factor = seconds() - ordered;
}

void CholeskyFactor::solve(Eigen::Ref<MatrixXd> X) const { backend_->L->solve(X); }

CholeskyFactor::~CholeskyFactor() = default;
CholeskyFactor::CholeskyFactor(CholeskyFactor&&) noexcept = default;
CholeskyFactor& CholeskyFactor::operator=(CholeskyFactor&&) noexcept = default;

}  // namespace flexarm::linear_solvers
