#include "flexarm/eigen/block_lanczos.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "flexarm/dense.hpp"
#include "flexarm/errors.hpp"
#include "flexarm/linear_solvers/dense_kernels.hpp"

namespace flexarm::eigen {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A direction that orthogonalisation shrinks below this part of its length is rounding.
constexpr double dependent = 1e-9;
// The first value left out serves as a frequency limit: error below this part squared, near enough.
constexpr double loose_tolerance = 1e-2;
// Values within this part of one another may be copies of one.
constexpr double cluster_width = 1e-3;
// What A makes of a vector, and a θ, below this part of the largest θ is rounding: a motion held still.
constexpr double nothing = 1e-13;
// Blocks without a further converged mode before the search is given up.
constexpr int patience = 60;

// Columns whose part along those before them falls below this one by one; the others all at once.
constexpr double nearly_dependent = 1e-4;
// A check of (3) costs the cube of the basis: the next one waits for this part of the way that is expected.
constexpr double part_of_way = 0.7;
constexpr double most_growth = 0.25;
constexpr Index cheap_check = 160;

linear_solvers::ConstPanel panel(const Eigen::Ref<const MatrixXd>& A) { return {A.data(), A.outerStride()}; }

/// Aᵀ B by the loaded BLAS.
MatrixXd inner_products(const Eigen::Ref<const MatrixXd>& A, const Eigen::Ref<const MatrixXd>& B) {
  MatrixXd C = MatrixXd::Zero(A.cols(), B.cols());
  linear_solvers::add_product(linear_solvers::Transposed::yes, linear_solvers::Transposed::no,
                              static_cast<int>(A.cols()), static_cast<int>(B.cols()),
                              static_cast<int>(A.rows()), 1, panel(A), panel(B), {C.data(), C.rows()});
  return C;
}

/// C := C + factor A B by the loaded BLAS.
void add(double factor, const Eigen::Ref<const MatrixXd>& A, const Eigen::Ref<const MatrixXd>& B,
         MatrixXd& C) {
  linear_solvers::add_product(linear_solvers::Transposed::no, linear_solvers::Transposed::no,
                              static_cast<int>(A.rows()), static_cast<int>(B.cols()),
                              static_cast<int>(A.cols()), factor, panel(A), panel(B), {C.data(), C.rows()});
}

/// Vectors with their products with M.
struct Block {
  MatrixXd U, MU;

  Block(const linear_solvers::LowerTriangle& M, MatrixXd vectors)
      : U(std::move(vectors)), MU(linear_solvers::multiply(M, U)) {}

  void refresh(const linear_solvers::LowerTriangle& M) { MU = linear_solvers::multiply(M, U); }
  VectorXd lengths() const { return U.cwiseProduct(MU).colwise().sum().cwiseMax(0.0).cwiseSqrt(); }
};

/// Growing M-orthonormal basis; `locked` vectors stay orthogonal to it.
class Basis {
 public:
  Basis(const linear_solvers::LowerTriangle& M, const MatrixXd& locked)
      : M_(M), locked_(locked), Q_(M.rows(), 0) {}

  Index size() const { return size_; }
  auto vectors() const { return Q_.leftCols(size_); }
  /// M times the block appended last.
  const MatrixXd& M_last() const { return M_last_; }

  /// U := U − Q C, M-orthogonal to all vectors; returns C. The recurrence (2) couples a block to the `local`
  /// vectors before it: they go first, so that one pass through all leaves nothing but rounding.
  MatrixXd project_out(Block& block, Index local) const {
    MatrixXd C = MatrixXd::Zero(size_, block.U.cols());
    for (const Index n : {local, size_}) {
      const auto Q = Q_.middleCols(size_ - n, n);
      const MatrixXd change = inner_products(Q, block.MU);
      if (locked_.cols() > 0) add(-1, locked_, inner_products(locked_, block.MU), block.U);
      add(-1, Q, change, block.U);
      C.bottomRows(n) += change;
      block.refresh(M_);
    }
    return C;
  }

  /// Appends an orthonormal basis of the columns of U, U = Q_new B; columns shorter than `shortest` add none.
  /// Returns B.
  MatrixXd append(Block block, const VectorXd& shortest) {
    auto& [V, MV] = block;
    MatrixXd B = orthonormalise(block, shortest);
    if (B.rows() == 0) B = orthonormalise_singly(block, shortest);
    const Index rank = B.rows();
    if (size_ + rank > Q_.cols()) Q_.conservativeResize(Eigen::NoChange, size_ + std::max<Index>(rank, 64));
    Q_.middleCols(size_, rank) = V.leftCols(rank);
    M_last_ = MV.leftCols(rank);
    size_ += rank;
    return B;
  }

 private:
  /// By Cholesky factors of VᵀMV, twice [Yamamoto2015]; no rows, and nothing done, where the columns are
  /// nearly dependent or short.
  static MatrixXd orthonormalise(Block& block, const VectorXd& shortest) {
    auto& [V, MV] = block;
    const VectorXd least = shortest.cwiseMax(nearly_dependent * block.lengths());
    const int n = static_cast<int>(V.cols());
    MatrixXd B = MatrixXd::Identity(n, n);
    for (int pass = 0; pass < 2; ++pass) {
      const MatrixXd G = inner_products(V, MV);
      const Eigen::LLT<MatrixXd> llt(0.5 * (G + G.transpose()));
      const MatrixXd L = llt.matrixL();
      const bool independent = llt.info() == Eigen::Success && (L.diagonal().array() > least.array()).all();
      if (pass == 0 && !independent) return MatrixXd(0, n);
      for (MatrixXd* X : {&V, &MV})
        linear_solvers::solve_right(static_cast<int>(X->rows()), n, {L.data(), n}, {X->data(), X->rows()});
      B = L.transpose() * B;
    }
    return B;
  }

  /// Column by column, short ones left out.
  static MatrixXd orthonormalise_singly(Block& block, const VectorXd& shortest) {
    auto& [V, MV] = block;
    MatrixXd B = MatrixXd::Zero(V.cols(), V.cols());
    Index rank = 0;
    for (Index c = 0; c < V.cols(); ++c) {
      VectorXd v = V.col(c), Mv = MV.col(c);
      for (int pass = 0; pass < 2; ++pass) {
        const VectorXd h = MV.leftCols(rank).transpose() * v;
        v -= V.leftCols(rank) * h;
        Mv -= MV.leftCols(rank) * h;
        B.col(c).head(rank) += h;
      }
      const double length = std::sqrt(std::max(v.dot(Mv), 0.0));
      if (length <= shortest[c]) continue;
      B(rank, c) = length;
      V.col(rank) = v / length;
      MV.col(rank) = Mv / length;
      ++rank;
    }
    return B.topRows(rank);
  }

  const linear_solvers::LowerTriangle& M_;
  const MatrixXd& locked_;
  MatrixXd Q_, M_last_;
  Index size_ = 0;
};

/// Ritz values of (3), falling, with the estimates of their residuals.
struct Ritz {
  VectorXd theta, residual;
  MatrixXd S;

  Index converged(double tolerance) const {
    Index k = 0;
    while (k < theta.size() && residual[k] <= tolerance * theta[k]) ++k;
    return k;
  }
};

/// One search from a random start in the complement of `locked`.
class Search {
 public:
  Search(const Flexibility& flexibility, const linear_solvers::LowerTriangle& M, const MatrixXd& locked,
         int block, unsigned seed)
      : flexibility_(flexibility),
        M_(M),
        locked_(locked),
        basis_(M, locked),
        generator_(seed),
        block_(block) {
    restart();
  }

  bool exhausted() const { return last_ == 0; }
  int steps() const { return steps_; }

  Index size() const { return basis_.size(); }

  /// One block more, eq. (2); whether `ritz` was renewed, as it is from a basis of size `due` on and where
  /// the subspace is invariant.
  bool advance(Index due, Ritz& ritz) {
    const Index k = basis_.size(), first = k - last_;
    Block block = apply(basis_.M_last());
    const VectorXd shortest = (dependent * block.lengths()).cwiseMax(nothing * largest_);
    const MatrixXd C = basis_.project_out(block, std::min(k, last_ + before_));
    grow(k);
    H_.block(0, first, k, last_) = C;
    H_.block(first, 0, last_, k) = C.transpose();
    const MatrixXd B = basis_.append(std::move(block), shortest);
    const bool renewed = k >= due || B.rows() < block_;
    if (renewed) ritz = solve(k, B);
    if (ritz.theta.size() > 0) largest_ = ritz.theta[0];
    before_ = last_;
    last_ = B.rows();
    if (last_ == 0) restart();  // an invariant subspace
    return renewed;
  }

  MatrixXd shapes(const Ritz& ritz, Index count) const {
    MatrixXd X = MatrixXd::Zero(M_.rows(), count);
    add(1, basis_.vectors().leftCols(ritz.S.rows()), ritz.S.leftCols(count), X);
    return X;
  }

 private:
  Block apply(const MatrixXd& MQ) {
    ++steps_;
    return {M_, flexibility_(MQ)};
  }

  /// A random block, brought into the range of A, where massless motions have no part.
  void restart() {
    std::normal_distribution<double> normal;
    const MatrixXd X = MatrixXd::NullaryExpr(M_.rows(), block_, [&] { return normal(generator_); });
    Block block = apply(linear_solvers::multiply(M_, X));
    const VectorXd shortest = dependent * block.lengths();
    basis_.project_out(block, basis_.size());
    last_ = basis_.append(std::move(block), shortest).rows();
  }

  void grow(Index k) {
    const Index old = H_.rows();
    H_.conservativeResize(k, k);
    H_.rightCols(k - old).setZero();
    H_.bottomRows(k - old).setZero();
  }

  Ritz solve(Index k, const MatrixXd& B) const {
    const auto [rising, vectors] = dense::eigenpairs(0.5 * (H_ + H_.transpose()));
    const Index n = (rising.array() > nothing * rising[k - 1]).count();
    Ritz ritz{rising.tail(n).reverse(), VectorXd::Zero(n), vectors.rightCols(n).rowwise().reverse()};
    if (B.rows() > 0) ritz.residual = (B * ritz.S.bottomRows(B.cols())).colwise().norm();  // eq. (3)
    return ritz;
  }

  const Flexibility& flexibility_;
  const linear_solvers::LowerTriangle& M_;
  const MatrixXd& locked_;
  Basis basis_;
  MatrixXd H_;
  std::mt19937 generator_;
  Index block_, last_ = 0, before_ = 0;
  double largest_ = 0;  // θ so far
  int steps_ = 0;
};

/// Which Ritz values are wanted: the first `count`, or all from `floor` up.
struct Target {
  Index count;
  double floor;

  Index wanted(const Ritz& ritz) const {
    if (floor <= 0) return std::min(count, ritz.theta.size());
    return (ritz.theta.array() >= floor).count();
  }
  /// All wanted ones are converged, and the first one left out is known well enough to stay out.
  bool reached(const Ritz& ritz, double tolerance) const {
    const Index n = wanted(ritz);
    if (floor <= 0 && n < count) return false;
    if (n >= ritz.theta.size() || ritz.converged(tolerance) < n) return false;
    if (ritz.residual[n] > loose_tolerance * ritz.theta[n]) return false;
    return floor <= 0 || ritz.theta[n] + ritz.residual[n] < floor || ritz.converged(tolerance) > n;
  }
};

/// Size of the basis at which (3) is looked at again, from how many of the wanted ones are converged,
/// whatever their places.
Index next_check(const Ritz& ritz, Index wanted, double tolerance) {
  const Index size = ritz.S.rows();
  if (size < cheap_check) return 0;
  const auto good = ritz.residual.head(wanted).array() <= tolerance * ritz.theta.head(wanted).array();
  const double left = wanted / std::max(1.0, 1.0 * good.count()) - 1;
  return size + static_cast<Index>(std::min(most_growth, part_of_way * left) * size);
}

NotConverged no_convergence(const Ritz& ritz, Index converged, int steps) {
  const double residual = ritz.residual[converged] / ritz.theta[converged];
  return {"modes: block Lanczos has found " + std::to_string(converged) + " modes, and no more in " +
              std::to_string(patience) + " blocks; relative residual of the next " + std::to_string(residual),
          0, steps, residual};
}

struct Found {
  VectorXd theta;
  MatrixXd shapes;
  double next = 0;  // θ of the first one left out
  int steps = 0;
};

Found search(const Flexibility& flexibility, const linear_solvers::LowerTriangle& M, const MatrixXd& locked,
             const Target& target, const LanczosOptions& options, unsigned seed,
             const std::function<void(double)>& progress) {
  Search search(flexibility, M, locked, options.block, seed);
  Ritz ritz{VectorXd(0), VectorXd(0), MatrixXd(0, 0)};
  Index converged = 0, due = 0;
  int last_success = 0;
  while (!search.exhausted()) {
    if (!search.advance(due, ritz)) continue;
    if (target.reached(ritz, options.tolerance)) break;
    const Index before = std::exchange(converged, ritz.converged(options.tolerance));
    if (converged > before) last_success = search.steps();
    const Index wanted = target.wanted(ritz);
    if (progress) progress(std::min(1.0, converged / std::max(1.0, 1.0 * wanted)));
    if (search.steps() > last_success + patience) throw no_convergence(ritz, converged, search.steps());
    due = next_check(ritz, wanted, options.tolerance);
  }
  const Index n = target.wanted(ritz);
  Found found{ritz.theta.head(n), search.shapes(ritz, n), 0, search.steps()};
  if (n < ritz.theta.size()) found.next = std::max(ritz.theta[n], 0.0);
  return found;
}

/// Whether p or more values lie together, so that one start of p vectors might not have seen them all.
bool crowded(const VectorXd& theta, Index p) {
  for (Index k = 0; k + p <= theta.size(); ++k) {
    if (theta[k] - theta[k + p - 1] <= cluster_width * theta[k]) return true;
  }
  return false;
}

/// Both sets of modes, θ falling.
Found merged(const Found& a, const Found& b) {
  const Index n = a.theta.size() + b.theta.size();
  VectorXd theta(n);
  theta << a.theta, b.theta;
  MatrixXd shapes(a.shapes.rows(), n);
  shapes << a.shapes, b.shapes;
  std::vector<Index> order(static_cast<std::size_t>(n));
  for (Index k = 0; k < n; ++k) order[static_cast<std::size_t>(k)] = k;
  std::stable_sort(order.begin(), order.end(), [&](Index i, Index j) { return theta[i] > theta[j]; });
  return {theta(order), shapes(Eigen::all, order), std::max(a.next, b.next), a.steps + b.steps};
}

}  // namespace

LanczosModes block_lanczos(const Flexibility& flexibility, const linear_solvers::LowerTriangle& M,
                           const LanczosOptions& options, const std::function<void(double)>& progress) {
  const Target target{options.count, options.max_lambda > 0 ? 1 / options.max_lambda : 0};
  Found found = search(flexibility, M, MatrixXd(M.rows(), 0), target, options, options.seed, progress);
  bool complete = !crowded(found.theta, options.block);
  for (unsigned seed = options.seed + 1; !complete; ++seed) {
    const double floor = target.floor > 0 ? target.floor : (1 + 1e-9) * found.theta[found.theta.size() - 1];
    const Found more = search(flexibility, M, found.shapes, {0, floor}, options, seed, nullptr);
    complete = !crowded(more.theta, options.block);
    found = merged(found, more);
  }
  const Index n = target.floor > 0 ? found.theta.size() : std::min<Index>(options.count, found.theta.size());
  if (n < found.theta.size()) found.next = std::max(found.next, found.theta[n]);
  LanczosModes modes;
  modes.lambda = found.theta.head(n).cwiseInverse();
  modes.shapes = found.shapes.leftCols(n);
  modes.next_lambda = 1 / found.next;
  modes.steps = found.steps;
  MatrixXd R =
      flexibility(linear_solvers::multiply(M, modes.shapes)) * modes.lambda.asDiagonal() - modes.shapes;
  modes.residual =
      R.cwiseProduct(linear_solvers::multiply(M, R)).colwise().sum().cwiseMax(0.0).cwiseSqrt();  // eq. (4)
  return modes;
}

}  // namespace flexarm::eigen
