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
  const Eigen::Index n = A.rows(), n_s = separator_.rows();
  b_.resize(n);
  x_s_.resize(n_s);
  const MatrixXd full = MatrixXd(A)(order_, order_);
  MatrixXd schur = full.bottomRightCorner(n_s, n_s);
  for (Part& part : parts_) eliminate(part, full, schur);
  if (n_s > 0) separator_ = schur.partialPivLu().inverse();
  VectorXd ones = A * VectorXd::Ones(n);
  solve(ones);
  return ((ones.array() - 1).abs() < half_of_the_digits).all();  // false for what is not a number, too
}

/// Parts, their boundaries and the new order of the unknowns.
void DissectedInverse::reorder(const Eigen::SparseMatrix<double>& A) {
  const Dissection cut = dissect(A, part_size);
  const auto n_s = static_cast<Eigen::Index>(cut.separator.size());
  order_.clear();
  parts_.clear();
  for (const auto& members : cut.parts) {
    Part part;
    part.first = static_cast<Eigen::Index>(order_.size());
    part.inverse.resize(static_cast<Eigen::Index>(members.size()), 0);
    order_.insert(order_.end(), members.begin(), members.end());
    for (int k = 0; k < n_s; ++k) {
      const int s = cut.separator[static_cast<std::size_t>(k)];
      const bool touches = std::any_of(members.begin(), members.end(),
                                       [&](int p) { return A.coeff(s, p) != 0 || A.coeff(p, s) != 0; });
      if (touches) part.boundary.push_back(k);
    }
    parts_.push_back(std::move(part));
  }
  order_.insert(order_.end(), cut.separator.begin(), cut.separator.end());
  separator_.resize(n_s, n_s);
}

/// The part's matrices of (2) and (3), and its share of (1).
void DissectedInverse::eliminate(Part& part, const MatrixXd& A, MatrixXd& schur) const {
  const Eigen::Index m = part.inverse.rows(), n_s = schur.rows();
  const auto n_boundary = static_cast<Eigen::Index>(part.boundary.size());
  const MatrixXd A_ps = A.block(part.first, A.cols() - n_s, m, n_s)(Eigen::all, part.boundary);
  const MatrixXd A_sp = A.block(A.rows() - n_s, part.first, n_s, m)(part.boundary, Eigen::all);
  const MatrixXd inverse = A.block(part.first, part.first, m, m).partialPivLu().inverse();
  part.inverse.resize(m + n_boundary, m);
  part.inverse << inverse, A_sp * inverse;
  part.from_boundary = inverse * A_ps;
  schur(part.boundary, part.boundary) -= A_sp * part.from_boundary;  // eq. (1)
  part.product.resize(m + n_boundary);
  part.beyond.resize(n_boundary);
}

void DissectedInverse::solve(VectorXd& x) {
  for (Eigen::Index k = 0; k < b_.size(); ++k) b_[k] = x[order_[static_cast<std::size_t>(k)]];
  auto b_s = b_.tail(x_s_.size());
  for (Part& part : parts_) {
    const Eigen::Index m = part.inverse.cols();
    part.product.noalias() = part.inverse * b_.segment(part.first, m);
    for (std::size_t k = 0; k < part.boundary.size(); ++k) {
      b_s[part.boundary[k]] -= part.product[m + static_cast<Eigen::Index>(k)];
    }
  }
  x_s_.noalias() = separator_ * b_s;  // eq. (2)
  b_s = x_s_;
  for (Part& part : parts_) {
    const Eigen::Index m = part.inverse.cols();
    for (std::size_t k = 0; k < part.boundary.size(); ++k) {
      part.beyond[static_cast<Eigen::Index>(k)] = x_s_[part.boundary[k]];
    }
    auto x_p = b_.segment(part.first, m);
    x_p = part.product.head(m);
    x_p.noalias() -= part.from_boundary * part.beyond;  // eq. (3)
  }
  for (Eigen::Index k = 0; k < b_.size(); ++k) x[order_[static_cast<std::size_t>(k)]] = b_[k];
}

}  // namespace flexarm::solvers
