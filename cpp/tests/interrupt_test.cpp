#include "flexarm/interrupt.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <thread>

#include "arms.hpp"
#include "flexarm/eigen/eigenmodes.hpp"
#include "flexarm/linear_solvers/cholesky_factor.hpp"
#include "flexarm/simulation/statics.hpp"

namespace flexarm::tests::interrupt_test {

namespace {

struct Stop {};

/// Every computation is told to stop while this lives.
struct Stopping {
  Stopping() {
    flexarm::set_interrupt_check([] { throw Stop{}; });
    wait();
  }
  ~Stopping() { flexarm::set_interrupt_check(nullptr); }
  /// The check is made fifty times a second at most.
  static void wait() { std::this_thread::sleep_for(std::chrono::milliseconds(25)); }
};

Eigen::SparseMatrix<double> diagonal(int n) {
  Eigen::SparseMatrix<double> D(n, n);
  for (int k = 0; k < n; ++k) D.insert(k, k) = 1.0 + k;
  D.makeCompressed();
  return D;
}

}  // namespace

TEST_CASE("Long computations end when they are told to, and go on when they are not") {
  const System system(paper_arm(), {{"hinge", DriveKind::motor_angle}});
  const auto K = diagonal(400);
  Eigen::SparseMatrix<double> I(400, 400), none(400, 400), J(0, 400);
  I.setIdentity();
  const auto statics = [&] { flexarm::simulation::static_equilibrium(system, {0.3}, {}); };
  const auto modes = [&] { flexarm::eigen::eigenmodes(K, none, I, J, 3); };
  statics();
  modes();
  const flexarm::linear_solvers::CholeskyFactor factor(K.triangularView<Eigen::Lower>());
  const Stopping stopping;
  CHECK_THROWS_AS(statics(), Stop);
  stopping.wait();
  CHECK_THROWS_AS(modes(), Stop);
  Eigen::MatrixXd X = Eigen::MatrixXd::Ones(400, 2);
  stopping.wait();
  CHECK_THROWS_AS(factor.solve(X), Stop);
}

}  // namespace flexarm::tests::interrupt_test
