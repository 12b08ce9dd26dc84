#include "flexarm/linear_solvers/triangular_factors.hpp"

#include <algorithm>
#include <cmath>

#include "flexarm/simd/columns.hpp"

namespace flexarm::linear_solvers {
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

/// Where an entry of rows and columns in the order of the pivots stands in work_; −1: nowhere.
int TriangularFactors::place(int row, int column, int first_of_block) const {
  const auto n_u = static_cast<int>(U.row.size()), n_l = static_cast<int>(L.row.size());
  const auto find = [&](const Part& part, int ahead) {
    const auto begin = part.row.begin() + part.start[column], end = part.row.begin() + part.start[column + 1];
    const auto found = std::find(begin, end, row);
    return found == end ? -1 : ahead + static_cast<int>(found - part.row.begin());
  };
  if (row < first_of_block) return find(F, n_u + n_l);
  return row <= column ? find(U, 0) : find(L, n_u);
}

bool TriangularFactors::find_places(const Eigen::SparseMatrix<double>& A) {
  const auto n = static_cast<int>(P.size());
  std::vector<int> position(n);  // of a row of A among the pivots
  for (int k = 0; k < n; ++k) position[P[k]] = k;
  place_.resize(A.nonZeros());
  weight_.resize(A.nonZeros());
  work_.resize(U.row.size() + L.row.size() + F.row.size());
  for (std::size_t block = 0; block + 1 < blocks.size(); ++block) {
    for (int k = blocks[block]; k < blocks[block + 1]; ++k) {
      for (int p = A.outerIndexPtr()[Q[k]]; p < A.outerIndexPtr()[Q[k] + 1]; ++p) {
        const int at = position[A.innerIndexPtr()[p]];
        weight_[p] = 1 / scale[at];
        place_[p] = place(at, k, blocks[block]);
        if (place_[p] < 0) return false;
      }
    }
  }
  return find_products();
}

bool TriangularFactors::find_products() {
  const auto n = static_cast<int>(P.size()), n_u = static_cast<int>(U.row.size());
  std::vector<std::vector<Product>> of_pivot(n);
  for (int k = 0; k < n; ++k) {
    for (int p = U.start[k]; p < U.start[k + 1] - 1; ++p) {
      const int j = U.row[p];
      for (int i = L.start[j] + 1; i < L.start[j + 1]; ++i) {
        const int target = place(L.row[i], k, 0);
        if (target < 0) return false;
        of_pivot[j].push_back({target, p, n_u + i});
      }
    }
  }
  products_.clear();
  first_product_.assign(1, 0);
  for (const std::vector<Product>& products : of_pivot) {
    products_.insert(products_.end(), products.begin(), products.end());
    first_product_.push_back(static_cast<int>(products_.size()));
  }
  return true;
}

bool TriangularFactors::refactor(const Eigen::SparseMatrix<double>& A) {
  if (place_.empty() && !find_places(A)) {
    place_.clear();
    return false;
  }
  const auto n = static_cast<int>(P.size());
  const std::size_t n_u = U.row.size(), n_l = L.row.size();
  double* value = work_.data();
  std::fill(work_.begin(), work_.end(), 0.0);
  for (Eigen::Index p = 0; p < A.nonZeros(); ++p) value[place_[p]] = weight_[p] * A.valuePtr()[p];
  double smallest = INFINITY, largest = 0;
  bool sound = true;  // what is not a number is not
  for (int k = 0; k < n; ++k) {
    const double pivot = value[U.start[k + 1] - 1], per_pivot = 1 / pivot;
    smallest = std::min(smallest, std::abs(pivot));
    largest = std::max(largest, std::abs(pivot));
    sound &= std::isfinite(pivot);
    double* column = value + n_u;
    column[L.start[k]] = 1;
    for (int i = L.start[k] + 1; i < L.start[k + 1]; ++i) {
      column[i] *= per_pivot;
      sound &= std::abs(column[i]) <= largest_multiplier;
    }
    for (int p = first_product_[k]; p < first_product_[k + 1]; ++p) {
      const Product& product = products_[p];
      value[product.target] -= value[product.u] * value[product.l];
    }
  }
  std::copy_n(value, n_u, U.value.begin());
  std::copy_n(value + n_u, n_l, L.value.begin());
  std::copy_n(value + n_u + n_l, F.value.size(), F.value.begin());
  return sound && smallest > singular_ratio * largest;
}

namespace {

// Columns at a time: each row waits for the one before, and the more of it there is the less that counts.
constexpr int widest = 8;

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
    for (int k = 0; k < n; ++k)
      simd::lanes<N>(rows + k * N) = per_scale[k] * simd::lanes<N>(X + P[k] * m + first);
    for (auto block = static_cast<int>(blocks.size()) - 2; block >= 0; --block) {
      const int begin = blocks[block], end = blocks[block + 1];
      for (int k = begin; k < end; ++k) subtract<N>(L, k, L.start[k] + 1, L.start[k + 1]);
      for (int k = end - 1; k >= begin; --k) {
        simd::lanes<N>(rows + k * N) = per_pivot[k] * simd::lanes<N>(rows + k * N);
        subtract<N>(U, k, U.start[k], U.start[k + 1] - 1);
      }
      for (int k = begin; k < end; ++k) subtract<N>(F, k, F.start[k], F.start[k + 1]);
    }
    for (int k = 0; k < n; ++k) simd::lanes<N>(X + Q[k] * m + first) = simd::lanes<N>(rows + k * N);
  }

  /// Takes column k of a factor, times the solution's k-th row, from the rows below or above.
  template <int N>
  [[gnu::always_inline]] void subtract(const TriangularFactors::Part& part, int k, int begin, int end) {
    const typename simd::Lanes<N>::type known = simd::lanes<N>(rows + k * N);
    const int* row = part.row.data();
    const double* value = part.value.data();
    for (int p = begin; p < end; ++p) simd::lanes<N>(rows + row[p] * N) -= value[p] * known;
  }
};

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
  simd::work_through<widest>(Substitution{*this, per_scale_.data(), per_pivot_.data(), X, m, rows_.data()},
                             m);
}

}  // namespace flexarm::linear_solvers
