#include "flexarm/simulation/statics.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cstdio>

#include "flexarm/errors.hpp"
#include "flexarm/integrators/increment.hpp"
#include "flexarm/interrupt.hpp"
#include "flexarm/linear_solvers/sparse_factor.hpp"
#include "flexarm/simulation/backlash.hpp"

namespace flexarm::simulation {
namespace {

using assembly::TangentFactors;
using Eigen::VectorXd;

// No iterate turns a node further than this [rad] or moves it further than this part of the reach at once.
constexpr double longest_increment = 0.5;

enum class Outcome { stable, unstable, diverged, singular };

/// Stiffness by which constraints are scaled, so that all pivots are of one size.
double typical_stiffness(const System& system) {
  double k = system.mass();
  for (const auto& beam : system.beams()) k = std::max(k, beam.stiffness()[4]);
  for (const auto& part : system.superelements()) {
    if (part.n_interfaces() > 1) k = std::max(k, part.deformation_stiffness()(4, 4));
  }
  return k;
}

class Newton {
 public:
  Newton(const System& system, const StaticOptions& options)
      : system_(system),
        options_(options),
        scale_(typical_stiffness(system)),
        r_(system.n_velocities()),
        phi_(system.n_constraints()),
        dx_(system.n_unknowns()) {}

  Outcome solve(State& state, const Loads& loads) {
    for (int k = 0; k < options_.max_iterations; ++k) {
      check_interrupt();
      ++iterations;
      if (!factor_.factor(system_.tangent(state, loads, {0, 0, 1, scale_}))) return Outcome::singular;
      unbalanced(state, loads);
      dx_ << -r_.head(system_.n_free()), -scale_ * phi_;
      factor_.solve(dx_);  // eq. (1)
      const double size = integrators::increment_norm(system_, dx_);
      if (!dx_.allFinite()) return Outcome::diverged;
      const double part = std::min(1.0, longest_increment / size);
      integrators::move(system_, part * dx_.head(system_.n_free()), state);
      state.multipliers += part * scale_ * dx_.tail(system_.n_constraints());
      if (size < options_.tolerance) {
        residual = unbalanced(state, loads);
        return is_stable(system_, state, loads) ? Outcome::stable : Outcome::unstable;
      }
    }
    residual = unbalanced(state, loads);
    return Outcome::diverged;
  }

  int iterations = 0;
  double residual = 0;

 private:
  double unbalanced(const State& state, const Loads& loads) {
    system_.residual(state, loads, false, r_);
    system_.violation(state, phi_);
    return r_.head(system_.n_free()).lpNorm<Eigen::Infinity>();
  }

  const System& system_;
  const StaticOptions& options_;
  double scale_;
  VectorXd r_, phi_, dx_;
  linear_solvers::SparseFactor factor_;
};

Loads scaled(const Loads& loads, double fraction) {
  Loads part = loads;
  part.gravity *= fraction;
  part.torques *= fraction;
  for (auto& load : part.points) {
    load.force *= fraction;
    load.moment *= fraction;
  }
  return part;
}

std::string failure_message(Outcome outcome, double fraction, double residual) {
  char text[256];
  switch (outcome) {
    case Outcome::unstable:
      if (fraction == 0)
        return "statics: the arm has no stable equilibrium near this pose, at any part of its load";
      std::snprintf(text, sizeof text,
                    "statics: the arm buckles at about %.3g of its load: beyond it no stable equilibrium "
                    "follows from this pose",
                    fraction);
      break;
    case Outcome::singular:
      std::snprintf(text, sizeof text,
                    "statics: nothing holds the arm at %.3g of its load: the stiffness matrix is singular (a "
                    "free joint or link?)",
                    fraction);
      break;
    default:
      std::snprintf(text, sizeof text,
                    "statics: no equilibrium found beyond %.3g of the load, residual %.1e N", fraction,
                    residual);
  }
  return text;
}

/// Puts the teeth of reducers with backlash on their flanks; the state rests with all gaps closed.
void settle_teeth(const System& system, const Loads& loads, Newton& newton, State& state) {
  open_gaps(system, state);
  Outcome outcome = Outcome::diverged;
  for (std::size_t pass = 0; pass < 2 + 4 * system.laws().size(); ++pass) {
    outcome = newton.solve(state, loads);
    if (outcome != Outcome::stable && outcome != Outcome::unstable) break;
    if (!correct_flanks(system, state, outcome == Outcome::stable) && outcome == Outcome::stable) return;
  }
  throw NotConverged("statics: the arm rests with the backlash of its reducers closed, but not with it open",
                     0, newton.iterations, newton.residual);
}

}  // namespace

bool is_stable(const System& system, const State& state, const Loads& loads) {
  if (system.n_free() == 0) return true;
  const Eigen::SparseMatrix<double> K = system.tangent(state, loads, {0, 0, 1, 1, true}, false);
  const Eigen::SparseMatrix<double> J = system.constraint_jacobian(state);
  double largest = system.mass();  // a rigid arm without gravity has no stiffness at all
  for (int k = 0; k < K.rows(); ++k) largest = std::max(largest, std::abs(K.coeff(k, k)));
  // On the constraints' null space this is K; across it, so stiff that its sign cannot matter.
  const Eigen::SparseMatrix<double> stiff = 0.5 * (K + Eigen::SparseMatrix<double>(K.transpose())) +
                                            1e4 * largest * Eigen::SparseMatrix<double>(J.transpose() * J);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(stiff);
  return factor.info() == Eigen::Success && (factor.vectorD().array() > 0).all();
}

Equilibrium static_equilibrium(const System& system, const std::vector<double>& joint_values,
                               const Loads& loads, const StaticOptions& options) {
  Equilibrium result{.state = system.rigid_state(joint_values), .loads = loads};
  result.state.t = result.state.start = options.time;
  close_gaps(system, result.state);
  Newton newton(system, options);
  double reached = 0, step = 1;
  Outcome outcome = Outcome::diverged;
  for (int halvings = 0; reached < 1;) {
    const double target = std::min(1.0, reached + step);
    State trial = result.state;
    outcome = newton.solve(trial, scaled(loads, target));
    if (outcome == Outcome::stable) {
      result.state = std::move(trial);
      reached = target;
      ++result.load_steps;
      halvings = std::max(0, halvings - 1);
      step *= 2;
    } else if (++halvings > options.max_halvings) {
      throw NotConverged(failure_message(outcome, reached, newton.residual), 0, newton.iterations,
                         newton.residual);
    } else {
      step = 0.5 * (target - reached);
    }
  }
  if (has_gaps(system)) settle_teeth(system, loads, newton, result.state);
  system.closures().check(result.state.frames, system.reach(), result.state.t);
  system.remember(result.state);
  result.iterations = newton.iterations;
  result.residual = newton.residual;
  return result;
}

}  // namespace flexarm::simulation
