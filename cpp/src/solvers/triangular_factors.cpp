#include "flexarm/solvers/triangular_factors.hpp"

#include <algorithm>
#include <cmath>

#include "flexarm/solvers/lanes.hpp"

namespace flexarm::solvers {
namespace {

// Entries of L beyond this cost four digits: ten times what KLU allows where it chooses pivots.
constexpr double largest_multiplier = 1e4;
// Pivots so far apart leave no digits.
constexpr double singular_ratio = 1e-18;

}  // namespace

void TriangularFactors::Part::resize(int n, int entries) {
  start.resize(n + 1);
  row.resize(entries);
  value.resize(entries);
}

void TriangularFactors::resize(int n, int l_entries, int u_entries, int f_entries, int n_blocks) {
  L.resize(n, l_entries);
  U.resize(n, u_entries);
  F.resize(n, f_entries);
  P.resize(n);
  Q.resize(n);
  blocks.resize(n_blocks + 1);
  scale.assign(n, 1.0);
  place_.clear();
}

/// Entries beside the blocks stand in F as they do in A, column after column.
void TriangularFactors::find_places(const Eigen::SparseMatrix<double>& A) {
  const auto n = static_cast<int>(P.size());
  std::vector<int> position(n);  // of a row of A among the pivots
  for (int k = 0; k < n; ++k) position[P[k]] = k;
  place_.resize(A.nonZeros());
  weight_.resize(A.nonZeros());
  x_.assign(n, 0.0);
  int beside = 0;
  for (std::size_t block = 0; block + 1 < blocks.size(); ++block) {
    for (int k = blocks[block]; k < blocks[block + 1]; ++k) {
      for (int p = A.outerIndexPtr()[Q[k]]; p < A.outerIndexPtr()[Q[k] + 1]; ++p) {
        const int at = position[A.innerIndexPtr()[p]];
        weight_[p] = 1 / scale[at];
        place_[p] = at >= blocks[block] ? at : -1 - beside++;
      }
    }
  }
}

void TriangularFactors::scatter(const Eigen::SparseMatrix<double>& A, int k) {
  const double* values = A.valuePtr();
  for (int p = A.outerIndexPtr()[Q[k]]; p < A.outerIndexPtr()[Q[k] + 1]; ++p) {
    (place_[p] >= 0 ? x_[place_[p]] : F.value[-1 - place_[p]]) = weight_[p] * values[p];
  }
}

bool TriangularFactors::refactor(const Eigen::SparseMatrix<double>& A) {
  if (place_.empty()) find_places(A);
  const auto n = static_cast<int>(P.size());
  double* x = x_.data();
  double smallest = INFINITY, largest = 0;
  bool sound = true;  // what is not a number is not
  for (int k = 0; k < n; ++k) {
    scatter(A, k);
    const int diagonal = U.start[k + 1] - 1;
    for (int p = U.start[k]; p < diagonal; ++p) {
      const int j = U.row[p];
      const double u = U.value[p] = x[j];
      x[j] = 0;
      for (int i = L.start[j] + 1; i < L.start[j + 1]; ++i) x[L.row[i]] -= u * L.value[i];
    }
    const double pivot = U.value[diagonal] = x[k], per_pivot = 1 / pivot;
    x[k] = 0;
    smallest = std::min(smallest, std::abs(pivot));
    largest = std::max(largest, std::abs(pivot));
    sound &= std::isfinite(pivot);
    for (int i = L.start[k] + 1; i < L.start[k + 1]; ++i) {
      L.value[i] = per_pivot * x[L.row[i]];
      x[L.row[i]] = 0;
      sound &= std::abs(L.value[i]) <= largest_multiplier;
    }
  }
  return sound && smallest > singular_ratio * largest;
}

namespace {

// Columns at a time: each row waits for the one before, and the more of it there is the less that counts.
constexpr int widest = 16;

/// Substitution for some columns of a right side.
struct Substitution {
  const TriangularFactors& factors;
  const double *per_scale, *per_pivot;
  double* X;
  Eigen::Index m;
  double* rows;  // of the solution, in the order of the pivots

  template <int N>
  [[gnu::always_inline]] void columns(Eigen::Index first) {
    const TriangularFactors::Part &L = factors.L, &U = factors.U, &F = factors.F;
    const std::vector<int>&P = factors.P, &Q = factors.Q, &blocks = factors.blocks;
    const auto n = static_cast<int>(P.size());
    for (int k = 0; k < n; ++k) lanes<N>(rows + k * N) = per_scale[k] * lanes<N>(X + P[k] * m + first);
    for (auto block = static_cast<int>(blocks.size()) - 2; block >= 0; --block) {
      const int begin = blocks[block], end = blocks[block + 1];
      for (int k = begin; k < end; ++k) subtract<N>(L, k, L.start[k] + 1, L.start[k + 1]);
      for (int k = end - 1; k >= begin; --k) {
        lanes<N>(rows + k * N) = per_pivot[k] * lanes<N>(rows + k * N);
        subtract<N>(U, k, U.start[k], U.start[k + 1] - 1);
      }
      for (int k = begin; k < end; ++k) subtract<N>(F, k, F.start[k], F.start[k + 1]);
    }
    for (int k = 0; k < n; ++k) lanes<N>(X + Q[k] * m + first) = lanes<N>(rows + k * N);
  }

  /// Takes column k of a factor, times the solution's k-th row, from the rows below or above.
  template <int N>
  [[gnu::always_inline]] void subtract(const TriangularFactors::Part& part, int k, int begin, int end) {
    const typename Lanes<N>::type known = lanes<N>(rows + k * N);
    const int* row = part.row.data();
    const double* value = part.value.data();
    for (int p = begin; p < end; ++p) lanes<N>(rows + row[p] * N) -= value[p] * known;
  }
};

FLEXARM_FOR_EVERY_PROCESSOR
void substitute(Substitution work) { by_columns<widest>(work, work.m); }

}  // namespace

void TriangularFactors::solve(double* X, Eigen::Index m) {
  const std::size_t n = P.size();
  per_scale_.resize(n);
  per_pivot_.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    per_scale_[k] = 1 / scale[k];
    per_pivot_[k] = 1 / U.value[U.start[k + 1] - 1];
  }
  rows_.resize(widest * n);
  substitute({*this, per_scale_.data(), per_pivot_.data(), X, m, rows_.data()});
}

}  // namespace flexarm::solvers
