#include "flexarm/simulation/consistent_start.hpp"

#include <algorithm>

#include "flexarm/linear_solvers/cached_factorisation.hpp"
#include "flexarm/simulation/consistent_forces.hpp"

namespace flexarm::simulation {
namespace {

using SpatialSystem = assembly::SystemIn<3>;

/// Coordinates without mass may take this part of the forces.
constexpr double left_over = 1e-6;

bool driven_by_torque(const System& system) {
  return std::ranges::any_of(system.drives(),
                             [](assembly::DriveKind kind) { return kind == assembly::DriveKind::torque; });
}

integrators::DriveValues values_at(const SpatialSystem& system, const integrators::Drives& drives,
                                   double time) {
  const VectorXd zero = VectorXd::Zero(system.n_scalars());
  integrators::DriveValues values{zero, zero, zero, zero};
  drives(time, values);
  return values;
}

double scale_of(const System& system) {
  return std::max(system.mass(), 1e-12) / std::max(1, system.n_nodes());
}

/// −(r, s c), the right side of (1) and (2).
VectorXd unbalanced(const SpatialSystem& system, const State& state, const Loads& loads, double scale) {
  VectorXd r(system.n_velocities()), phi(system.n_constraints()), c(system.n_constraints());
  system.evaluate(state, loads, r, phi);
  system.constraint_acceleration(state, c);
  VectorXd sides(system.n_unknowns());
  sides << -r.head(system.n_free()), -scale * c;
  return sides;
}

/// A of (1), constraints and multipliers scaled.
class MassesAndConstraints {
 public:
  MassesAndConstraints(const System& system, const State& state, double scale)
      : n_free_(system.n_free()), A_(system.tangent(state, {}, {1, 0, 0, scale}, true)) {
    const double largest = A_.diagonal().head(n_free_).maxCoeff();
    for (int k = 0; k < n_free_; ++k) {
      if (A_.coeff(k, k) != 0) continue;
      massless_.push_back(k);
      A_.coeffRef(k, k) = added_ = nearly_massless * largest;
    }
    A_.makeCompressed();
    regular_ = factor_.factor(A_);
  }

  /// x := A⁻¹ x. @return false where a coordinate without mass would have to jump
  bool solve(VectorXd& x) {
    const double allowed = left_over * x.head(n_free_).lpNorm<Eigen::Infinity>();
    if (!regular_) return false;
    factor_.solve(x);
    return x.allFinite() &&
           std::ranges::all_of(massless_, [&](int k) { return added_ * std::abs(x[k]) <= allowed; });
  }

 private:
  int n_free_;
  Eigen::SparseMatrix<double> A_;
  std::vector<int> massless_;
  double added_ = 0;
  linear_solvers::CachedFactorisation factor_;
  bool regular_ = false;
};

}  // namespace

Equilibrium consistent_start(const System& system, const Equilibrium& equilibrium,
                             const integrators::Drives& drives, double time) {
  const bool moves = !equilibrium.state.v.isZero(0);
  if (!moves && !driven_by_torque(system)) return equilibrium;
  Equilibrium start = equilibrium;
  const integrators::DriveValues told = values_at(system, drives, time);
  start.loads.torques = told.torques;
  if (moves) {
    const int n_driven = system.n_velocities() - system.n_free();
    start.state.v.tail(n_driven) = told.v.tail(n_driven);
    start.state.v_dot.tail(n_driven) = start.state.a.tail(n_driven) = told.v_dot.tail(n_driven);
  }
  const double scale = scale_of(system);
  VectorXd x = unbalanced(system, start.state, start.loads, scale);
  if (!MassesAndConstraints(system, start.state, scale).solve(x)) return equilibrium;  // eq. (1)
  start.state.v_dot.head(system.n_free()) += x.head(system.n_free());
  start.state.a.head(system.n_free()) = start.state.v_dot.head(system.n_free());
  start.state.multipliers += scale * x.tail(system.n_constraints());
  return start;
}

StateDerivative consistent_start(const System& system, const Equilibrium& start, double time,
                                 const std::vector<Variation>& variations, StateDerivative derivative,
                                 const Slopes& torques) {
  if (start.state.v_dot.isZero(0)) return derivative;
  const double scale = scale_of(system);
  MassesAndConstraints A(system, start.state, scale);
  const StateDerivative at_rest = derivative;
  for (Eigen::Index k = 0; k < derivative.size(); ++k) {
    const Variation& p = variations[static_cast<std::size_t>(k)];
    const auto in = [&](const SpatialSystem& model, const integrators::Drives& drives, double amount) {
      Loads loads = start.loads;
      if (drives) loads.torques = values_at(system, drives, time).torques;
      return unbalanced(model, moved(system, start.state, at_rest, k, amount), loads, scale);
    };
    VectorXd x = (in(*p.plus, p.drive_plus, p.up) - in(*p.minus, p.drive_minus, p.down)) / p.spread();
    for (int s = 0; s < static_cast<int>(torques.rows()); ++s) {
      if (system.is_free(s)) x[system.scalar_offset() + s] += torques(s, k);
    }
    if (!A.solve(x)) return at_rest;  // eq. (2)
    derivative.v_dot.col(k).head(system.n_free()) += x.head(system.n_free());
    derivative.a.col(k).head(system.n_free()) += x.head(system.n_free());
    derivative.multipliers.col(k) += scale * x.tail(system.n_constraints());
  }
  return derivative;
}

}  // namespace flexarm::simulation
