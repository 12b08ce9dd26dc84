#include "flexarm/sensitivity/modal_derivative.hpp"

#include <cmath>
#include <numbers>

#include "flexarm/dense.hpp"
#include "flexarm/eigen/eigenmodes.hpp"

namespace flexarm::sensitivity {
namespace {

using namespace simulation;

using Sparse = Eigen::SparseMatrix<double>;

constexpr double one_frequency = 1e-6;

struct Matrices {
  Sparse K, M, J;
};

Matrices matrices(const assembly::SystemIn<3>& system, const State& state, const Loads& loads) {
  return {system.tangent(state, loads, {0, 0, 1, 1, true}, false),
          system.tangent(state, loads, {1, 0, 0}, false), system.constraint_jacobian(state)};
}

/// The forces μ of the constraints in every mode.
MatrixXd mode_multipliers(const Matrices& at, const eigen::Eigenmodes& modes) {
  if (at.J.rows() == 0) return MatrixXd::Zero(0, modes.shapes.cols());
  const MatrixXd unbalanced = at.K * modes.shapes - at.M * modes.shapes * modes.omega_squared.asDiagonal();
  return dense::least_squares(MatrixXd(at.J.transpose()), -unbalanced);
}

}  // namespace

MatrixXd frequency_derivatives(const System& system, const Equilibrium& equilibrium, int count,
                               const std::vector<Variation>& variations) {
  const StateDerivative d = static_derivative(system, equilibrium, variations);
  const Matrices at = matrices(system, equilibrium.state, equilibrium.loads);
  const eigen::Eigenmodes modes =
      eigen::eigenmodes(at.K, Sparse(system.n_free(), system.n_free()), at.M, at.J, count);
  const MatrixXd& X = modes.shapes;
  const MatrixXd mu = mode_multipliers(at, modes);
  MatrixXd derivatives(X.cols(), static_cast<Eigen::Index>(variations.size()));
  for (Eigen::Index p = 0; p < derivatives.cols(); ++p) {
    const Variation& varied = variations[p];
    const auto there = [&](const assembly::SystemIn<3>& model, double amount) {
      return matrices(model, moved(system, equilibrium.state, d, p, amount), equilibrium.loads);
    };
    const Matrices up = there(*varied.plus, varied.up), down = there(*varied.minus, varied.down);
    const auto form = [&](const Sparse& plus, const Sparse& minus, const MatrixXd& left) -> MatrixXd {
      return left.transpose() * (Sparse(plus - minus) * X) / varied.spread();
    };
    const MatrixXd dK = form(up.K, down.K, X), dM = form(up.M, down.M, X);
    const MatrixXd dJ = form(up.J, down.J, mu);
    for (Eigen::Index first = 0, last = 0; first < X.cols(); first = last) {
      const double omega_squared = modes.omega_squared[first];
      while (last < X.cols() &&
             modes.omega_squared[last] - omega_squared <= 2 * one_frequency * std::abs(omega_squared)) {
        ++last;
      }
      const Eigen::Index n = last - first;
      MatrixXd A = dK.block(first, first, n, n) - omega_squared * dM.block(first, first, n, n) +
                   dJ.block(first, first, n, n) + dJ.block(first, first, n, n).transpose();  // eq. (1)
      const Eigen::VectorXd d_omega_squared = dense::eigenvalues(0.5 * (A + A.transpose()));
      const double omega = std::sqrt(std::max(omega_squared, 0.0));
      derivatives.col(p).segment(first, n) = d_omega_squared / (4 * std::numbers::pi * omega);
    }
  }
  return derivatives;
}

}  // namespace flexarm::sensitivity
