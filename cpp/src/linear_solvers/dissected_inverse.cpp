#include "flexarm/linear_solvers/dissected_inverse.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "flexarm/dense.hpp"
#include "flexarm/linear_solvers/dissection.hpp"

namespace flexarm::linear_solvers {
namespace {

// Products of the first size are out of their start-up costs and still small. Where such parts hold
// multipliers without the node that these hold, which is singular, larger ones may hold both.
constexpr std::array part_sizes = {20, 40, 80};
// Largest error of a known solution of ones.
constexpr double half_of_the_digits = 1e-8;
// A pivot so many times the rest of its row and column grows no error.
constexpr double outweighs = 10;

}  // namespace

bool DissectedInverse::invert(const Eigen::SparseMatrix<double>& whole) {
  leaves_ = find_leaves(whole);
  const Eigen::SparseMatrix<double> A = leaves_.empty() ? whole : without_leaves(whole);
  return std::any_of(part_sizes.begin(), part_sizes.end(), [&](int size) {
    invert_cut(A, size);
    return solves(whole);
  });
}

/// All matrices of (2) and (3), with parts of about this size.
void DissectedInverse::invert_cut(const Eigen::SparseMatrix<double>& A, int part_size) {
  reorder(A, part_size);
  const Eigen::Index n = A.rows(), n_s = n_separated_;
  b_.resize(n);
  const MatrixXd full = MatrixXd(A)(order_, order_);
  MatrixXd schur = full.bottomRightCorner(n_s, n_s);
  for (Part& part : parts_) eliminate(part, full, schur);
  separator_ = PackedMatrix(n_s > 0 ? dense::inverse(schur) : MatrixXd(0, 0));
  x_s_.resize(separator_.filled_rows());
  if (!leaves_.empty()) {
    for (int& k : order_) k = rest_[static_cast<std::size_t>(k)];
  }
}

/// Whether a solution that is known comes out.
bool DissectedInverse::solves(const Eigen::SparseMatrix<double>& whole) {
  VectorXd ones = whole * VectorXd::Ones(whole.cols());
  solve(ones);
  return ((ones.array() - 1).abs() < half_of_the_digits).all();  // false for what is not a number, too
}

/// Unknowns of (4), in rising order.
std::vector<DissectedInverse::Leaf> DissectedInverse::find_leaves(
    const Eigen::SparseMatrix<double>& A) const {
  const Eigen::SparseMatrix<double> transposed = A.transpose();
  VectorXd pivot = A.diagonal(), in_row = -pivot.cwiseAbs(), in_column = in_row;
  for (int k = 0; k < A.outerSize(); ++k) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(A, k); it; ++it) {
      in_row[it.row()] += std::abs(it.value());
      in_column[k] += std::abs(it.value());
    }
  }
  std::vector<Leaf> leaves;
  std::vector<bool> taken(static_cast<std::size_t>(A.cols()), false);
  for (int i = 0; i < A.cols(); ++i) {
    if (!(std::abs(pivot[i]) > outweighs * std::max(in_row[i], in_column[i]))) continue;
    std::map<int, Leaf::Entry> entries;
    for (Eigen::SparseMatrix<double>::InnerIterator it(A, i); it; ++it) {
      const int other = static_cast<int>(it.row());
      entries[other] = {other, 0, it.value() / pivot[i]};
    }
    for (Eigen::SparseMatrix<double>::InnerIterator it(transposed, i); it; ++it) {
      const int other = static_cast<int>(it.row());
      entries.try_emplace(other, Leaf::Entry{other, 0, 0}).first->second.in_row = it.value() / pivot[i];
    }
    entries.erase(i);
    const bool touches = std::any_of(entries.begin(), entries.end(),
                                     [&](const auto& entry) { return taken[entry.second.other]; });
    if (touches) continue;
    taken[i] = true;
    Leaf leaf{i, 1 / pivot[i], {}};
    for (const auto& [other, entry] : entries) {
      if (entry.in_row != 0 || entry.in_column != 0) leaf.entries.push_back(entry);
    }
    leaves.push_back(std::move(leaf));
  }
  return leaves;
}

/// A' of (4), and what is left in it.
Eigen::SparseMatrix<double> DissectedInverse::without_leaves(const Eigen::SparseMatrix<double>& A) {
  std::vector<int> place(static_cast<std::size_t>(A.cols()), 0);  // among the rest; −1: a leaf
  for (const Leaf& leaf : leaves_) place[leaf.unknown] = -1;
  rest_.clear();
  for (int k = 0; k < A.cols(); ++k) {
    if (place[k] < 0) continue;
    place[k] = static_cast<int>(rest_.size());
    rest_.push_back(k);
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < A.outerSize(); ++k) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(A, k); it; ++it) {
      if (place[it.row()] >= 0 && place[k] >= 0) entries.emplace_back(place[it.row()], place[k], it.value());
    }
  }
  for (const Leaf& leaf : leaves_) {
    for (const auto& j : leaf.entries) {
      for (const auto& k : leaf.entries) {
        const double change = -j.in_column * k.in_row / leaf.per_pivot;  // eq. (4)
        entries.emplace_back(place[j.other], place[k.other], change);
      }
    }
  }
  const auto n = static_cast<Eigen::Index>(rest_.size());
  Eigen::SparseMatrix<double> rest(n, n);
  rest.setFromTriplets(entries.begin(), entries.end());
  return rest;
}

/// Parts, their boundaries and the new order of the unknowns.
void DissectedInverse::reorder(const Eigen::SparseMatrix<double>& A, int part_size) {
  const Dissection cut = dissect(A, part_size);
  n_separated_ = static_cast<Eigen::Index>(cut.separator.size());
  order_.clear();
  parts_.clear();
  for (const auto& members : cut.parts) {
    Part part;
    part.first = static_cast<Eigen::Index>(order_.size());
    part.size = static_cast<Eigen::Index>(members.size());
    order_.insert(order_.end(), members.begin(), members.end());
    for (int k = 0; k < n_separated_; ++k) {
      const int s = cut.separator[static_cast<std::size_t>(k)];
      const bool touches = std::any_of(members.begin(), members.end(),
                                       [&](int p) { return A.coeff(s, p) != 0 || A.coeff(p, s) != 0; });
      if (touches) part.boundary.push_back(k);
    }
    parts_.push_back(std::move(part));
  }
  order_.insert(order_.end(), cut.separator.begin(), cut.separator.end());
}

/// The part's matrices of (2) and (3), and its share of (1).
void DissectedInverse::eliminate(Part& part, const MatrixXd& A, MatrixXd& schur) const {
  const Eigen::Index m = part.size, n_s = schur.rows();
  const auto n_boundary = static_cast<Eigen::Index>(part.boundary.size());
  const MatrixXd A_ps = A.block(part.first, A.cols() - n_s, m, n_s)(Eigen::all, part.boundary);
  const MatrixXd A_sp = A.block(A.rows() - n_s, part.first, n_s, m)(part.boundary, Eigen::all);
  const MatrixXd inverse = dense::inverse(A.block(part.first, part.first, m, m));
  const MatrixXd from_boundary = inverse * A_ps;
  schur(part.boundary, part.boundary) -= A_sp * from_boundary;  // eq. (1)
  MatrixXd both(m + n_boundary, m);
  both << inverse, A_sp * inverse;
  part.inverse = PackedMatrix(both);
  part.from_boundary = PackedMatrix(from_boundary);
  part.product.resize(part.inverse.filled_rows());
  part.beyond.resize(n_boundary);
  part.from_it.resize(part.from_boundary.filled_rows());
}

void DissectedInverse::solve(VectorXd& x) {
  for (const Leaf& leaf : leaves_) {
    const double b = x[leaf.unknown];
    for (const auto& entry : leaf.entries) x[entry.other] -= entry.in_column * b;  // eq. (4)
  }
  solve_rest(x);
  for (const Leaf& leaf : leaves_) {
    double known = leaf.per_pivot * x[leaf.unknown];
    for (const auto& entry : leaf.entries) known -= entry.in_row * x[entry.other];
    x[leaf.unknown] = known;  // eq. (4)
  }
}

void DissectedInverse::solve_rest(VectorXd& x) {
  for (Eigen::Index k = 0; k < b_.size(); ++k) b_[k] = x[order_[static_cast<std::size_t>(k)]];
  auto b_s = b_.tail(n_separated_);
  for (Part& part : parts_) {
    part.inverse.multiply(b_.data() + part.first, part.product.data());
    for (std::size_t k = 0; k < part.boundary.size(); ++k) {
      b_s[part.boundary[k]] -= part.product[part.size + static_cast<Eigen::Index>(k)];
    }
  }
  separator_.multiply(b_s.data(), x_s_.data());  // eq. (2)
  b_s = x_s_.head(n_separated_);
  for (Part& part : parts_) {
    auto x_p = b_.segment(part.first, part.size);
    x_p = part.product.head(part.size);
    if (part.boundary.empty()) continue;
    for (std::size_t k = 0; k < part.boundary.size(); ++k) {
      part.beyond[static_cast<Eigen::Index>(k)] = x_s_[part.boundary[k]];
    }
    part.from_boundary.multiply(part.beyond.data(), part.from_it.data());
    x_p -= part.from_it.head(part.size);  // eq. (3)
  }
  for (Eigen::Index k = 0; k < b_.size(); ++k) x[order_[static_cast<std::size_t>(k)]] = b_[k];
}

}  // namespace flexarm::linear_solvers
