#include "flexarm/simulation/sensitivity.hpp"

#include <algorithm>
#include <cmath>

#include "flexarm/errors.hpp"
#include "flexarm/simulation/sampled_run.hpp"

namespace flexarm::simulation {
namespace {

using namespace geometry;
using solvers::DriveValues;

/// Constraints are scaled to the size of the diagonal, as in the stepper.
double largest_diagonal(const Eigen::SparseMatrix<double>& A, Eigen::Index n) {
  double largest = 0;
  for (Eigen::Index k = 0; k < n; ++k) largest = std::max(largest, std::abs(A.coeff(k, k)));
  return largest > 0 ? largest : 1.0;
}

DriveValues drive_values(const System& system, const solvers::Drives& drives, double t) {
  const VectorXd zero = VectorXd::Zero(system.n_scalars());
  DriveValues values{zero, zero, zero, zero};
  drives(t, values);
  return values;
}

/// Prescribed rows of a derivative at the state's time.
void prescribe(const System& system, const std::vector<Variation>& variations, double t,
               StateDerivative& derivative) {
  const int n_driven = system.n_velocities() - system.n_free();
  for (Eigen::Index k = 0; k < derivative.size(); ++k) {
    const Variation& p = variations[k];
    if (!p.drive_plus || n_driven == 0) continue;
    const DriveValues up = drive_values(system, p.drive_plus, t);
    const DriveValues down = drive_values(system, p.drive_minus, t);
    derivative.position.col(k).tail(n_driven) = (up.s - down.s).tail(n_driven) / p.spread();
    derivative.velocity.col(k).tail(n_driven) = (up.v - down.v).tail(n_driven) / p.spread();
    derivative.v_dot.col(k).tail(n_driven) = (up.v_dot - down.v_dot).tail(n_driven) / p.spread();
  }
}

/// ∂r/∂p and ∂Φ/∂p at fixed free coordinates: prescribed ones and memories of laws move along.
/// n_free() + n_constraints() rows, one column a parameter.
MatrixXd partial_residuals(const System& system, const std::vector<Variation>& variations, const State& state,
                           const StateDerivative& derivative, const Loads& loads, bool friction) {
  const int n = system.n_free(), n_driven = system.n_velocities() - n;
  VectorXd r(system.n_velocities()), phi(system.n_constraints());
  MatrixXd partial(system.n_unknowns(), derivative.size());
  State varied = state;
  Loads varied_loads = loads;
  const auto add = [&](const System& model, const solvers::Drives& drive, Eigen::Index k, double amount,
                       double sign) {
    varied.s.tail(n_driven) = state.s.tail(n_driven) + amount * derivative.position.col(k).tail(n_driven);
    varied.v.tail(n_driven) = state.v.tail(n_driven) + amount * derivative.velocity.col(k).tail(n_driven);
    varied.v_dot.tail(n_driven) =
        state.v_dot.tail(n_driven) + amount * derivative.v_dot.col(k).tail(n_driven);
    for (std::size_t law = 0; law < state.laws.size(); ++law) {
      varied.laws[law] = {state.laws[law].x + amount * derivative.law_x(law, k),
                          state.laws[law].z + amount * derivative.law_z(law, k)};
    }
    if (drive) varied_loads.torques = drive_values(system, drive, state.t).torques;
    model.residual(varied, varied_loads, friction, r);
    model.violation(varied, phi);
    partial.col(k).head(n) += sign * r.head(n);
    partial.col(k).tail(phi.size()) += sign * phi;
  };
  partial.setZero();
  for (Eigen::Index k = 0; k < derivative.size(); ++k) {
    const Variation& p = variations[k];
    add(*p.plus, p.drive_plus, k, p.up, 1 / p.spread());
    add(*p.minus, p.drive_minus, k, p.down, -1 / p.spread());
    varied_loads.torques = loads.torques;
  }
  return partial;
}

/// At rest the laws remember the deflections there.
void remember_deflections(const System& system, StateDerivative& d) {
  for (std::size_t k = 0; k < system.laws().size(); ++k) {
    const auto& law = system.laws()[k];
    const int offset = system.scalar_offset();
    d.law_x.row(k) = d.position.row(offset + law.plus);
    if (law.minus >= 0) d.law_x.row(k) -= d.position.row(offset + law.minus);
  }
}

}  // namespace

StateDerivative static_derivative(const System& system, const Equilibrium& equilibrium,
                                  const std::vector<Variation>& variations) {
  for (const Variation& p : variations) p.check(system);
  const State& state = equilibrium.state;
  StateDerivative d(system, static_cast<Eigen::Index>(variations.size()));
  prescribe(system, variations, state.t, d);
  d.velocity.setZero();  // at rest, however the drives begin
  d.v_dot.setZero();
  assembly::TangentParts parts(system);
  parts.assemble(state, equilibrium.loads, 1.0, false);
  const double scale = largest_diagonal(parts.K(), system.n_free());
  parts.assemble(state, equilibrium.loads, scale, false);
  solvers::SparseFactor factor;
  if (!factor.factor(parts.K())) {
    throw NotConverged("derivative of an equilibrium: the stiffness matrix is singular", state.t, 0, 0);
  }
  MatrixXd x = -partial_residuals(system, variations, state, d, equilibrium.loads, false);
  x.bottomRows(system.n_constraints()) *= scale;
  factor.solve(x);
  d.position.topRows(system.n_free()) = x.topRows(system.n_free());
  d.multipliers = scale * x.bottomRows(system.n_constraints());
  remember_deflections(system, d);
  return d;
}

StateDerivative released(const System& held, const StateDerivative& derivative, const System& system) {
  StateDerivative d(system, derivative.size());
  const int nodes = system.scalar_offset();
  d.position.topRows(nodes) = derivative.position.topRows(nodes);
  const std::vector<int> origin = scalar_origins(held, system);
  for (int k = 0; k < system.n_scalars(); ++k) {
    if (origin[k] >= 0) d.position.row(nodes + k) = derivative.position.row(nodes + origin[k]);
  }
  d.multipliers = derivative.multipliers;
  remember_deflections(system, d);
  return d;
}

Sensitivities::Sensitivities(const System& system, const solvers::HhtCoefficients& coefficients,
                             std::vector<Variation> variations, StateDerivative initial)
    : system_(system),
      coefficients_(coefficients),
      variations_(std::move(variations)),
      now_(std::move(initial)),
      parts_(system) {
  for (const Variation& p : variations_) p.check(system);
}

void Sensitivities::follow(const State& before, const State& after, const VectorXd& exponent, double h,
                           const Loads& loads) {
  const auto [alpha, beta, gamma] = coefficients_;
  const int n = system_.n_free();
  before_ = now_;
  prescribe(system_, variations_, after.t, now_);
  State state = after;
  state.laws = before.laws;  // with which the step was made
  rhs_ = -partial_residuals(system_, variations_, state, now_, loads, true);
  const double scale = system_.mass() / (system_.n_nodes() * beta * h * h);
  rhs_.bottomRows(system_.n_constraints()) *= scale;
  parts_.assemble(state, loads, scale, true);

  // What (2) and (3) give at ξ₁ = 0.
  const auto v0 = before_.velocity.topRows(n), v_dot0 = before_.v_dot.topRows(n), a0 = before_.a.topRows(n);
  MatrixXd shift = before_.position.topRows(n);
  for (int k = 0; k < system_.n_nodes(); ++k) {
    shift.middleRows<6>(6 * k) =
        left_tangent_inverse(exponent.segment<6>(6 * k)) * before_.position.middleRows<6>(6 * k);  // eq. (1)
  }
  shift += h * v0;
  const MatrixXd a_rest = -shift / (beta * h * h) - (0.5 - beta) / beta * a0;
  V_.setZero(system_.n_unknowns(), now_.size());
  A_.setZero(system_.n_unknowns(), now_.size());
  V_.topRows(n) = v0 + h * ((1 - gamma) * a0 + gamma * a_rest);
  A_.topRows(n) = (a_rest + alpha * v_dot0) / (1 + alpha);
  rhs_.noalias() -= parts_.C() * V_;
  rhs_.noalias() -= parts_.M() * A_;

  factor(exponent, h);
  factor_.solve(rhs_);  // eq. (4)
  now_.position.topRows(n) = rhs_.topRows(n);
  now_.multipliers = scale * rhs_.bottomRows(system_.n_constraints());
  MatrixXd turned = rhs_.topRows(n);
  for (int k = 0; k < system_.n_nodes(); ++k) {
    turned.middleRows<6>(6 * k) =
        right_tangent_inverse(exponent.segment<6>(6 * k)) * rhs_.middleRows<6>(6 * k);
  }
  now_.a.topRows(n) = turned / (beta * h * h) + a_rest;                                // eq. (2)
  now_.velocity.topRows(n) = v0 + h * ((1 - gamma) * a0 + gamma * now_.a.topRows(n));  // eq. (3)
  now_.v_dot.topRows(n) = (now_.a.topRows(n) + alpha * v_dot0) / (1 + alpha);
  remember(before, after);
}

/// Equation (5).
void Sensitivities::factor(const VectorXd& exponent, double h) {
  const auto [alpha, beta, gamma] = coefficients_;
  const double c_C = gamma / (beta * h), c_M = 1 / (beta * h * h * (1 + alpha));
  if (S_.nonZeros() == 0) S_ = parts_.K();
  const double *M = parts_.M().valuePtr(), *C = parts_.C().valuePtr(), *K = parts_.K().valuePtr();
  double* S = S_.valuePtr();
  parts_.visit_columns([&](int first, int count, int begin, int rows) {
    if (count == 1) {
      for (int i = begin; i < begin + rows; ++i) S[i] = K[i] + c_C * C[i] + c_M * M[i];
      return;
    }
    using Block = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 6>>;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 6>>(S + begin, rows, 6).noalias() =
        Block(K + begin, rows, 6) + (c_C * Block(C + begin, rows, 6) + c_M * Block(M + begin, rows, 6)) *
                                        right_tangent_inverse(exponent.segment<6>(first));
  });
  if (!factor_.factor(S_)) {
    throw NotConverged("sensitivities: the tangent of a step is singular", 0, 0, 0);
  }
}

/// Memories of the laws after the step, by the laws' own rule for both values of each parameter.
void Sensitivities::remember(const State& before, const State& after) {
  const int offset = system_.scalar_offset();
  for (std::size_t k = 0; k < system_.laws().size(); ++k) {
    const auto& law = system_.laws()[k];
    const double x = system_.deflection(law, after.s);
    const double x_dot = system_.deflection(law, after.v.tail(system_.n_scalars()));
    for (Eigen::Index p = 0; p < now_.size(); ++p) {
      const auto of = [&](const MatrixXd& rows) {
        return rows(offset + law.plus, p) - (law.minus < 0 ? 0.0 : rows(offset + law.minus, p));
      };
      const double dx = of(now_.position), dx_dot = of(now_.velocity);
      const auto memory = [&](const System& system, double amount) {
        const joints::LawMemory old{before.laws[k].x + amount * before_.law_x(k, p),
                                    before.laws[k].z + amount * before_.law_z(k, p)};
        return joints::respond(system.laws()[k].law, x + amount * dx, x_dot + amount * dx_dot, old).z;
      };
      const Variation& varied = variations_[p];
      now_.law_x(k, p) = dx;
      now_.law_z(k, p) =
          (memory(*varied.plus, varied.up) - memory(*varied.minus, varied.down)) / varied.spread();
    }
  }
}

}  // namespace flexarm::simulation
