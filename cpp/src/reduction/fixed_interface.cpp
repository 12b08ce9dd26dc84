#include "flexarm/reduction/fixed_interface.hpp"

#include "flexarm/errors.hpp"

namespace flexarm::reduction {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linear_solvers::LowerTriangle;
using SparseMatrix = Eigen::SparseMatrix<double>;

// Beside entries of size one: below it two average interfaces say the same.
constexpr double dependent = 1e-10;

std::vector<int> inner_freedoms(const InterfaceMaps& maps, const Support& support) {
  std::vector<bool> held = maps.follows;
  for (const int j : support.isostatic) held[static_cast<std::size_t>(j)] = true;
  std::vector<int> inner;
  for (std::size_t j = 0; j < held.size(); ++j) {
    if (!held[j] && support.used[j / 3]) inner.push_back(static_cast<int>(j));
  }
  return inner;
}

/// Lower triangle of the rows and columns `kept`, which rise.
SparseMatrix submatrix(const LowerTriangle& A, const std::vector<int>& kept) {
  std::vector<int> place(static_cast<std::size_t>(A.rows()), -1);
  for (std::size_t k = 0; k < kept.size(); ++k)
    place[static_cast<std::size_t>(kept[k])] = static_cast<int>(k);
  const auto each_kept = [&](auto&& take) {
    for (const int j : kept)
      for (LowerTriangle::InnerIterator it(A, j); it; ++it) {
        const int row = place[static_cast<std::size_t>(it.row())];
        if (row >= 0) take(row, place[static_cast<std::size_t>(j)], it.value());
      }
  };
  SparseMatrix B(static_cast<Index>(kept.size()), static_cast<Index>(kept.size()));
  Eigen::VectorXi count = Eigen::VectorXi::Zero(B.cols());
  each_kept([&](int, int column, double) { ++count[column]; });
  B.reserve(count);
  each_kept([&](int row, int column, double value) { B.insert(row, column) = value; });
  B.makeCompressed();
  return B;
}

std::unique_ptr<const linear_solvers::CholeskyFactor> factor_inner(const LowerTriangle& K,
                                                                   const std::vector<int>& inner,
                                                                   const Coordinates& coordinates) {
  if (inner.empty()) {
    throw InvalidParameter("the rigid interfaces hold every point of the part: nothing is left to reduce");
  }
  try {
    return std::make_unique<linear_solvers::CholeskyFactor>(submatrix(K, inner));
  } catch (const linear_solvers::NotPositiveDefinite& error) {
    throw InvalidParameter(
        name_of_freedom(coordinates, inner[static_cast<std::size_t>(error.column)]) +
        ": with all interfaces held the part still moves there without force; is a piece of "
        "it hinged, or are elements inverted?");
  }
}

}  // namespace

FixedInterface::FixedInterface(const LowerTriangle& K, const Coordinates& coordinates,
                               const std::vector<Interface>& interfaces, const InterfaceMaps& maps,
                               const Support& support)
    : inner_(inner_freedoms(maps, support)),
      factor_(factor_inner(K, inner_, coordinates)),
      Wt_(maps.average) {
  R_.resize(K.rows(), 0);
  if (support.floating) R_ = scaled_rigid_motion(coordinates, support);
  border(interfaces);
}

void FixedInterface::border(const std::vector<Interface>& interfaces) {
  const Index n_lambda = Wt_.cols(), n_c = R_.cols();
  if (n_lambda == 0) return;
  Y_ = solve_unconstrained(MatrixXd(Wt_));
  MatrixXd A = MatrixXd::Zero(n_lambda + n_c, n_lambda + n_c);
  A.topLeftCorner(n_lambda, n_lambda) = Wt_.transpose() * Y_;
  A.topRightCorner(n_lambda, n_c) = -(Wt_.transpose() * R_);
  A.bottomLeftCorner(n_c, n_lambda) = A.topRightCorner(n_lambda, n_c).transpose();
  scale_ = VectorXd::Ones(n_lambda + n_c);
  for (Index k = 0; k < n_lambda; ++k) scale_[k] = A(k, k) > 0 ? 1 / std::sqrt(A(k, k)) : 1;
  for (Index k = n_lambda; k < n_lambda + n_c; ++k) scale_[k] = 1 / (scale_.cwiseProduct(A.col(k))).norm();
  border_.setThreshold(dependent);
  border_.compute(scale_.asDiagonal() * A * scale_.asDiagonal());
  if (border_.isInvertible()) return;
  std::string names;
  for (const Interface& interface : interfaces) {
    if (interface.kind == InterfaceKind::average)
      names += (names.empty() ? "'" : ", '") + interface.name + "'";
  }
  throw InvalidParameter(
      "interface " + names +
      ": frames on average do not move on their own; they share points with one another or "
      "with rigid interfaces");
}

MatrixXd FixedInterface::solve_unconstrained(const MatrixXd& F) const {
  MatrixXd X = F(inner_, Eigen::all);
  factor_->solve(X);
  MatrixXd U = MatrixXd::Zero(F.rows(), F.cols());
  U(inner_, Eigen::all) = X;
  return U;
}

MatrixXd FixedInterface::solve(const MatrixXd& F) const {
  return solve(F, MatrixXd::Zero(Wt_.cols(), F.cols()));
}

MatrixXd FixedInterface::solve(const MatrixXd& F, const MatrixXd& g) const {
  MatrixXd U = solve_unconstrained(F);
  const Index n_lambda = Wt_.cols();
  if (n_lambda == 0) return U;
  MatrixXd right(n_lambda + R_.cols(), F.cols());
  right << Wt_.transpose() * U - g, -R_.transpose() * F;
  const MatrixXd x = scale_.asDiagonal() * border_.solve(scale_.asDiagonal() * right);  // eq. (3)
  U -= Y_ * x.topRows(n_lambda);
  U += R_ * x.bottomRows(R_.cols());  // eq. (2)
  return U;
}

}  // namespace flexarm::reduction
