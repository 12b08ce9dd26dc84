#include "flexarm/linear_solvers/supernodal_factor.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>

#include "flexarm/interrupt.hpp"
#include "flexarm/linear_solvers/dense_kernels.hpp"
#include "flexarm/linear_solvers/panel_solve.hpp"
#include "flexarm/linear_solvers/wide_rows.hpp"

namespace flexarm::linear_solvers {
namespace {

using Eigen::Index;
using Ints = std::vector<int>;

// Columns eliminated together within a supernode.
constexpr int strip = 64;
// Columns of U in (1) between two looks at the clock.
constexpr int slab = 1024;

std::size_t bytes(std::ptrdiff_t entries) { return sizeof(double) * static_cast<std::size_t>(entries); }

/// Untouched until written, unlike a vector: most of it is zero, and the system gives zeros for nothing.
double* zeros(std::ptrdiff_t entries) {
  void* memory = std::calloc(bytes(std::max<std::ptrdiff_t>(entries, 1)), 1);
  if (memory == nullptr) throw std::bad_alloc();
  return static_cast<double*>(memory);
}

}  // namespace

/// The matrices U of (1) that still wait for their parents, one after the other.
class SupernodalFactor::Fronts {
 public:
  Fronts(SupernodalFactor& factor, const Eigen::VectorXd& diagonal)
      : factor_(factor), nodes_(factor.nodes_), diagonal_(diagonal), place_(nodes_.order.size()) {
    std::ptrdiff_t waiting = 0, most = 0;
    std::vector<std::ptrdiff_t> left(nodes_.parent.size(), 0);
    for (int s = 0; s < nodes_.count(); ++s) {
      most = std::max(most, waiting + size(s));
      waiting += size(s) - left[s];
      if (nodes_.parent[s] >= 0) left[nodes_.parent[s]] += size(s);
    }
    stack_.reset(zeros(most));
  }

  /// Eq. (1). Whether all pivots are positive.
  bool eliminate(int s) {
    const int n_columns = nodes_.n_columns(s), n_rows = nodes_.n_rows(s);
    const Panel L{factor_.L_.get() + factor_.start_[s], n_columns + n_rows};
    const Panel U{stack_.get() + top_, n_rows};
    std::memset(U.data, 0, bytes(size(s)));
    std::ptrdiff_t begin = top_;
    for (; !waiting_.empty() && nodes_.parent[waiting_.back()] == s; waiting_.pop_back()) {
      begin -= size(waiting_.back());
      take_over(waiting_.back(), {stack_.get() + begin, nodes_.n_rows(waiting_.back())}, s, L, U);
    }
    if (!factor_columns(s, L, n_columns, n_columns + n_rows)) return false;
    for (int j = 0; j < n_rows; j += slab) {
      check_interrupt();
      const int width = std::min(slab, n_rows - j);
      const ConstPanel A = L.at(n_columns + j, 0);
      subtract_square(width, n_columns, A, U.at(j, j));
      add_product(Transposed::no, Transposed::yes, n_rows - j - width, width, n_columns, -1,
                  L.at(n_columns + j + width, 0), A, U.at(j + width, j));
    }
    if (begin != top_) std::memmove(stack_.get() + begin, U.data, bytes(size(s)));
    top_ = begin + size(s);
    waiting_.push_back(s);
    return true;
  }

 private:
  std::ptrdiff_t size(int s) const { return std::ptrdiff_t(nodes_.n_rows(s)) * nodes_.n_rows(s); }

  /// Adds U of a child to the columns L and the rest U of s.
  void take_over(int child, Panel from, int s, Panel L, Panel U) {
    const int* rows = nodes_.rows.data() + nodes_.row_start[child];
    const int n = nodes_.n_rows(child), n_columns = nodes_.n_columns(s), first = nodes_.first[s];
    const int* own = nodes_.rows.data() + nodes_.row_start[s];
    place_.resize(static_cast<std::size_t>(n));
    int inside = 0, k = 0;
    for (int i = 0; i < n; ++i) {
      if (rows[i] < first + n_columns) {
        place_[i] = rows[i] - first;
        inside = i + 1;
      } else {
        while (own[k] != rows[i]) ++k;
        place_[i] = n_columns + k;
      }
    }
    ends_.resize(static_cast<std::size_t>(n));  // of runs without gaps
    for (int i = n - 1; i >= 0; --i)
      ends_[i] = i + 1 < n && place_[i + 1] == place_[i] + 1 ? ends_[i + 1] : i + 1;
    for (int j = 0; j < n; ++j) {
      double* to = j < inside ? &L(0, place_[j]) : &U(0, place_[j] - n_columns) - n_columns;
      const double* column = &from(0, j);
      for (int i = j; i < n;) {
        const int end = ends_[i];
        double* target = to + place_[i] - i;
        for (; i < end; ++i) target[i] += column[i];
      }
    }
  }

  /// L11 and L21 of (1), strip by strip.
  bool factor_columns(int s, Panel L, int n_columns, int height) {
    for (int j = 0; j < n_columns; j += strip) {
      check_interrupt();
      const int width = std::min(strip, n_columns - j);
      add_product(Transposed::no, Transposed::yes, height - j, width, j, -1, L.at(j, 0), L.at(j, 0),
                  L.at(j, j));
      if (!factor_block(nodes_.first[s] + j, L.at(j, j), width)) return false;
      solve_right(height - j - width, width, L.at(j, j), L.at(j + width, j));
    }
    return true;
  }

  /// A diagonal block whose first column is `first` in the order of elimination.
  bool factor_block(int first, Panel A, int n) {
    for (int j = 0; j < n; ++j) {
      double* column = &A(0, j);
      for (int k = 0; k < j; ++k) {
        const double* before = &A(0, k);
        const double factor = before[j];
        for (int i = j; i < n; ++i) column[i] -= factor * before[i];
      }
      if (!note(first + j, column[j])) return false;
      const double scale = 1 / std::sqrt(column[j]);
      for (int i = j; i < n; ++i) column[i] *= scale;
    }
    return true;
  }

  bool note(int k, double pivot) {
    const int column = nodes_.order[k];
    const double part = pivot / std::abs(diagonal_[column]);
    if (!(part >= factor_.least_pivot_.part)) factor_.least_pivot_ = {part, column};
    return pivot > 0;
  }

  SupernodalFactor& factor_;
  const Supernodes& nodes_;
  const Eigen::VectorXd& diagonal_;
  Memory stack_;
  std::ptrdiff_t top_ = 0;
  Ints waiting_, place_, ends_;
};

SupernodalFactor::SupernodalFactor(const LowerTriangle& A, const Supernodes& nodes) : nodes_(nodes) {
  std::ptrdiff_t total = 0;
  for (int s = 0; s < nodes.count(); ++s) {
    start_.push_back(total);
    total += std::ptrdiff_t(nodes.n_columns(s)) * (nodes.n_columns(s) + nodes.n_rows(s));
  }
  L_.reset(zeros(total));
  scatter(A);
  const Eigen::VectorXd own = diagonal(A);
  least_pivot_.column = nodes.order.empty() ? 0 : nodes.order[0];
  Fronts fronts(*this, own);
  for (int s = 0; s < nodes.count(); ++s)
    if (!fronts.eliminate(s)) return;
}

/// A into the columns of the supernodes.
void SupernodalFactor::scatter(const LowerTriangle& A) {
  const std::size_t n = nodes_.order.size();
  Ints place(n), owner(n);
  for (std::size_t k = 0; k < n; ++k) place[nodes_.order[k]] = static_cast<int>(k);
  for (int s = 0; s < nodes_.count(); ++s)
    std::fill(owner.begin() + nodes_.first[s], owner.begin() + nodes_.first[s + 1], s);
  // The row within a supernode of the entry before: neighbours in A are neighbours there.
  int last_supernode = -1, last_row = -1, last_place = 0;
  for (int j = 0; j < A.cols(); ++j)
    for (LowerTriangle::InnerIterator it(A, j); it; ++it) {
      const auto [column, row] = std::minmax(place[j], place[it.row()]);
      const int s = owner[column], n_columns = nodes_.n_columns(s), within = column - nodes_.first[s];
      int at = row - nodes_.first[s];
      if (at >= n_columns) {
        const int* rows = nodes_.rows.data() + nodes_.row_start[s];
        if (s != last_supernode || row != last_row + 1 || last_place + 1 >= nodes_.n_rows(s) ||
            rows[last_place + 1] != row)
          last_place = static_cast<int>(std::lower_bound(rows, rows + nodes_.n_rows(s), row) - rows);
        else
          ++last_place;
        last_supernode = s;
        last_row = row;
        at = n_columns + last_place;
      }
      L_[start_[s] + at + std::ptrdiff_t(within) * (n_columns + nodes_.n_rows(s))] = it.value();
    }
}

void SupernodalFactor::solve(Eigen::Ref<Eigen::MatrixXd> X) const {
  for (Index k = 0, p; k < X.cols(); k += p) {
    const int left = static_cast<int>(X.cols() - k), width = width_of(left);
    p = std::min(width, left);
    solve_together(X.middleCols(k, p), width);
  }
}

/// Rows of X in the order of elimination lie together, so that each supernode moves whole rows.
void SupernodalFactor::solve_together(Eigen::Ref<Eigen::MatrixXd> X, int width) const {
  int most = 0;
  for (int s = 0; s < nodes_.count(); ++s) most = std::max(most, nodes_.n_columns(s) + nodes_.n_rows(s));
  Eigen::MatrixXd Y = Eigen::MatrixXd::Zero(width, X.rows()), local(width, most);
  for (Index k = 0; k < X.rows(); ++k) Y.col(k).head(X.cols()) = X.row(nodes_.order[k]);
  const auto factor = [&](int s) {
    return ConstPanel{L_.get() + start_[s], nodes_.n_columns(s) + nodes_.n_rows(s)};
  };
  for (int s = 0; s < nodes_.count(); ++s) {
    check_interrupt();
    const int n = nodes_.n_columns(s), m = nodes_.n_rows(s), *rows = nodes_.rows.data() + nodes_.row_start[s];
    auto own = Y.middleCols(nodes_.first[s], n);
    local.leftCols(n) = own;
    local.middleCols(n, m).setZero();
    solve_forward(width, n, n + m, factor(s), local.data());
    own = local.leftCols(n);
    for (int i = 0; i < m; ++i) Y.col(rows[i]) += local.col(n + i);
  }
  for (int s = nodes_.count() - 1; s >= 0; --s) {
    check_interrupt();
    const int n = nodes_.n_columns(s), m = nodes_.n_rows(s), *rows = nodes_.rows.data() + nodes_.row_start[s];
    auto own = Y.middleCols(nodes_.first[s], n);
    local.leftCols(n) = own;
    for (int i = 0; i < m; ++i) local.col(n + i) = Y.col(rows[i]);
    solve_backward(width, n, n + m, factor(s), local.data());
    own = local.leftCols(n);
  }
  for (Index k = 0; k < X.rows(); ++k) X.row(nodes_.order[k]) = Y.col(k).head(X.cols());
}

}  // namespace flexarm::linear_solvers
