#include "flexarm/simulation/modal.hpp"

#include <cmath>
#include <numbers>

namespace flexarm::simulation {
namespace {

/// Motion of every point in base axes when the arm moves along a shape.
Eigen::VectorXd at_points(const System& system, State state, const Eigen::Ref<const Eigen::VectorXd>& shape) {
  const auto n_points = static_cast<int>(system.points().size());
  state.v.setZero();
  state.v.head(system.n_free()) = shape;
  Eigen::VectorXd motion(6 * n_points);
  for (int p = 0; p < n_points; ++p) {
    const auto& R = system.point_frame(state, p).R;
    const geometry::Vector6d v = system.point_velocity(state, p);
    motion.segment<6>(6 * p) << R * v.head<3>(), R * v.tail<3>();
  }
  return motion;
}

}  // namespace

Modes modes(const System& system, const Equilibrium& equilibrium, int count) {
  const State& state = equilibrium.state;
  const auto part = [&](double m, double c, double k) {
    return system.tangent(state, equilibrium.loads, {m, c, k, 1, true}, false);
  };
  Eigen::SparseMatrix<double> C = part(0, 1, 0);
  C.prune(0.0);
  const eigen::Eigenmodes found =
      eigen::eigenmodes(part(0, 0, 1), C, part(1, 0, 0), system.constraint_jacobian(state), count);
  Modes modes;
  modes.iterations = found.iterations;
  const Eigen::Index n = found.omega_squared.size();
  modes.shapes.resize(6 * static_cast<Eigen::Index>(system.points().size()), n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double omega = std::sqrt(std::max(0.0, found.omega_squared[k]));
    const bool damped = k < found.damped.size() && std::abs(found.damped[k]) > 0;
    modes.frequency_hz.push_back(omega / (2 * std::numbers::pi));
    modes.damping_ratio.push_back(damped ? -found.damped[k].real() / std::abs(found.damped[k]) : 0.0);
    modes.damped_frequency_hz.push_back((damped ? found.damped[k].imag() : omega) / (2 * std::numbers::pi));
    modes.shapes.col(k) = at_points(system, state, found.shapes.col(k));
  }
  return modes;
}

}  // namespace flexarm::simulation
