#include "flexarm/solvers/dissected_inverse.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "flexarm/solvers/dissection.hpp"

namespace flexarm::solvers {
namespace {

// Products of this size are out of their start-up costs and still small.
constexpr int part_size = 20;
// Largest error of a known solution of ones.
constexpr double half_of_the_digits = 1e-8;

}  // namespace

bool DissectedInverse::invert(const Eigen::SparseMatrix<double>& A) {
  reorder(A);
  const Eigen::Index n = A.rows(), n_s = n_separated_;
  b_.resize(n);
  const MatrixXd full = MatrixXd(A)(order_, order_);
  MatrixXd schur = full.bottomRightCorner(n_s, n_s);
  for (Part& part : parts_) eliminate(part, full, schur);
  separator_ = PackedMatrix(n_s > 0 ? MatrixXd(schur.partialPivLu().inverse()) : MatrixXd(0, 0));
  x_s_.resize(separator_.filled_rows());
  VectorXd ones = A * VectorXd::Ones(n);
  solve(ones);
  return ((ones.array() - 1).abs() < half_of_the_digits).all();  // false for what is not a number, too
}

/// Parts, their boundaries and the new order of the unknowns.
void DissectedInverse::reorder(const Eigen::SparseMatrix<double>& A) {
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
  const MatrixXd inverse = A.block(part.first, part.first, m, m).partialPivLu().inverse();
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

}  // namespace flexarm::solvers
