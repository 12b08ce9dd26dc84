#include "flexarm/simulation/sensitivity.hpp"

#include <algorithm>
#include <cmath>

#include "flexarm/errors.hpp"
#include "flexarm/simulation/sampled_run.hpp"

namespace flexarm::simulation {
namespace {

using namespace geometry;
using assembly::LoadsIn;
using assembly::StateIn;
using assembly::SystemIn;
using solvers::DriveValues;

/// Constraints are scaled to the size of the diagonal, as in the stepper.
double largest_diagonal(const Eigen::SparseMatrix<double>& A, Eigen::Index n) {
  double largest = 0;
  for (Eigen::Index k = 0; k < n; ++k) largest = std::max(largest, std::abs(A.coeff(k, k)));
  return largest > 0 ? largest : 1.0;
}

DriveValues drive_values(Eigen::Index n_scalars, const solvers::Drives& drives, double t) {
  const VectorXd zero = VectorXd::Zero(n_scalars);
  DriveValues values{zero, zero, zero, zero};
  drives(t, values);
  return values;
}

/// Prescribed rows of a derivative at the state's time.
template <int D>
void prescribe(const SystemIn<D>& system, const std::vector<VariationIn<D>>& variations, double t,
               StateDerivative& derivative) {
  const int n_driven = system.n_velocities() - system.n_free();
  for (Eigen::Index k = 0; k < derivative.size(); ++k) {
    const VariationIn<D>& p = variations[k];
    if (!p.drive_plus || n_driven == 0) continue;
    const DriveValues up = drive_values(system.n_scalars(), p.drive_plus, t);
    const DriveValues down = drive_values(system.n_scalars(), p.drive_minus, t);
    derivative.position.col(k).tail(n_driven) = (up.s - down.s).tail(n_driven) / p.spread();
    derivative.velocity.col(k).tail(n_driven) = (up.v - down.v).tail(n_driven) / p.spread();
    derivative.v_dot.col(k).tail(n_driven) = (up.v_dot - down.v_dot).tail(n_driven) / p.spread();
  }
}

/// What the two models of a variation do not share, all of it where prescribed coordinates move too.
template <int D>
std::pair<SystemIn<D>, SystemIn<D>> differences(const VariationIn<D>& p) {
  if (p.drive_plus) return {*p.plus, *p.minus};
  return {p.plus->different_from(*p.minus), p.minus->different_from(*p.plus)};
}

/// −∂(r, Φ)/∂p at fixed free coordinates: prescribed ones and memories of laws move along.
/// n_free() + n_constraints() rows, one column a parameter.
template <int D>
void partial_residuals(const SystemIn<D>& system, const std::vector<VariationIn<D>>& variations,
                       const std::vector<std::pair<SystemIn<D>, SystemIn<D>>>& differing,
                       const StateIn<D>& state, const StateDerivative& derivative, const LoadsIn<D>& loads,
                       bool friction, MatrixXd& rhs) {
  const int n = system.n_free(), n_driven = system.n_velocities() - n;
  VectorXd r(system.n_velocities()), phi(system.n_constraints());
  StateIn<D> varied = state;
  LoadsIn<D> varied_loads = loads;
  rhs.setZero(system.n_unknowns(), derivative.size());
  const auto subtract = [&](const SystemIn<D>& model, const solvers::Drives& drive, Eigen::Index k,
                            double amount, double sign) {
    if (drive) {
      varied.s.tail(n_driven) = state.s.tail(n_driven) + amount * derivative.position.col(k).tail(n_driven);
      varied.v.tail(n_driven) = state.v.tail(n_driven) + amount * derivative.velocity.col(k).tail(n_driven);
      varied.v_dot.tail(n_driven) =
          state.v_dot.tail(n_driven) + amount * derivative.v_dot.col(k).tail(n_driven);
      varied_loads.torques = drive_values(system.n_scalars(), drive, state.t).torques;
    }
    for (std::size_t law = 0; law < state.laws.size(); ++law) {
      varied.laws[law].x = state.laws[law].x + amount * derivative.law_x(law, k);
      varied.laws[law].z = state.laws[law].z + amount * derivative.law_z(law, k);
    }
    model.residual(varied, varied_loads, friction, r);
    phi.setZero();
    model.violation(varied, phi);
    rhs.col(k).head(n) -= sign * r.head(n);
    rhs.col(k).tail(phi.size()) -= sign * phi;
  };
  for (Eigen::Index k = 0; k < derivative.size(); ++k) {
    const VariationIn<D>& p = variations[k];
    subtract(differing[k].first, p.drive_plus, k, p.up, 1 / p.spread());
    subtract(differing[k].second, p.drive_minus, k, p.down, -1 / p.spread());
    if (!p.drive_plus) continue;
    varied.s = state.s;
    varied.v = state.v;
    varied.v_dot = state.v_dot;
    varied_loads.torques = loads.torques;
  }
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
  prescribe<3>(system, variations, state.t, d);
  d.velocity.setZero();  // at rest, however the drives begin
  d.v_dot.setZero();
  assembly::TangentPartsIn<3> parts(system);
  parts.assemble(state, equilibrium.loads, 1.0, false);
  const double scale = largest_diagonal(parts.K(), system.n_free());
  parts.assemble(state, equilibrium.loads, scale, false);
  solvers::SparseFactor factor;
  if (!factor.factor(parts.K())) {
    throw NotConverged("derivative of an equilibrium: the stiffness matrix is singular", state.t, 0, 0);
  }
  std::vector<std::pair<SystemIn<3>, SystemIn<3>>> differing;
  for (const Variation& p : variations) differing.push_back(differences(p));
  MatrixXd x;
  partial_residuals<3>(system, variations, differing, state, d, equilibrium.loads, false, x);
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

template <int D>
SensitivitiesIn<D>::SensitivitiesIn(const SystemD& system, const solvers::HhtCoefficients& coefficients,
                                    std::vector<VariationIn<D>> variations, StateDerivative initial)
    : system_(system),
      coefficients_(coefficients),
      variations_(std::move(variations)),
      now_(std::move(initial)),
      parts_(system) {
  for (const VariationIn<D>& p : variations_) {
    p.check(system);
    differences_.push_back(differences(p));
  }
}

template <int D>
void SensitivitiesIn<D>::follow(const StateD& before, const StateD& after, const VectorXd& exponent, double h,
                                const LoadsD& loads) {
  before_ = now_;
  prescribe(system_, variations_, after.t, now_);
  state_ = after;
  state_.laws = before.laws;  // with which the step was made
  const double scale = system_.mass() / (system_.n_nodes() * coefficients_.beta * h * h);
  partial_residuals(system_, variations_, differences_, state_, now_, loads, true, rhs_);
  rhs_.bottomRows(system_.n_constraints()) *= scale;
  parts_.assemble(state_, loads, scale, true);
  carry(exponent, h);
  rhs_.noalias() -= parts_.C() * V_;
  rhs_.noalias() -= parts_.M() * A_;
  factor(exponent, h);
  factor_.solve(rhs_);  // eq. (4)
  now_.multipliers = scale * rhs_.bottomRows(system_.n_constraints());
  update(exponent, h);
  remember(before, after);
}

/// What (2) and (3) give at ξ₁ = 0: what state 0 brings along.
template <int D>
void SensitivitiesIn<D>::carry(const VectorXd& exponent, double h) {
  const auto [alpha, beta, gamma] = coefficients_;
  constexpr int n_node = freedoms<D>;
  const int n = system_.n_free();
  const auto v0 = before_.velocity.topRows(n), v_dot0 = before_.v_dot.topRows(n), a0 = before_.a.topRows(n);
  a_rest_ = before_.position.topRows(n);
  for (int k = 0; k < system_.n_nodes(); ++k) {
    const Twist<D> h_k = exponent.segment<n_node>(n_node * k);
    a_rest_.template middleRows<n_node>(n_node * k) =
        left_tangent_inverse<D>(h_k) * before_.position.template middleRows<n_node>(n_node * k);  // eq. (1)
  }
  a_rest_ = -(a_rest_ + h * v0) / (beta * h * h) - (0.5 - beta) / beta * a0;
  V_.setZero(system_.n_unknowns(), now_.size());
  A_.setZero(system_.n_unknowns(), now_.size());
  V_.topRows(n) = v0 + h * ((1 - gamma) * a0 + gamma * a_rest_);
  A_.topRows(n) = (a_rest_ + alpha * v_dot0) / (1 + alpha);
}

/// Equations (1) to (3) from ξ₁.
template <int D>
void SensitivitiesIn<D>::update(const VectorXd& exponent, double h) {
  const auto [alpha, beta, gamma] = coefficients_;
  constexpr int n_node = freedoms<D>;
  const int n = system_.n_free();
  const auto v0 = before_.velocity.topRows(n), v_dot0 = before_.v_dot.topRows(n), a0 = before_.a.topRows(n);
  now_.position.topRows(n) = rhs_.topRows(n);
  for (int k = 0; k < system_.n_nodes(); ++k) {
    const Twist<D> h_k = exponent.segment<n_node>(n_node * k);
    rhs_.template middleRows<n_node>(n_node * k) =
        (right_tangent_inverse<D>(h_k) * rhs_.template middleRows<n_node>(n_node * k)).eval();
  }
  now_.a.topRows(n) = rhs_.topRows(n) / (beta * h * h) + a_rest_;                      // eq. (2)
  now_.velocity.topRows(n) = v0 + h * ((1 - gamma) * a0 + gamma * now_.a.topRows(n));  // eq. (3)
  now_.v_dot.topRows(n) = (now_.a.topRows(n) + alpha * v_dot0) / (1 + alpha);
}

/// Equation (5).
template <int D>
void SensitivitiesIn<D>::factor(const VectorXd& exponent, double h) {
  const auto [alpha, beta, gamma] = coefficients_;
  constexpr int n_node = freedoms<D>;
  const double c_C = gamma / (beta * h), c_M = 1 / (beta * h * h * (1 + alpha));
  if (S_.nonZeros() == 0) S_ = parts_.K();
  const double *M = parts_.M().valuePtr(), *C = parts_.C().valuePtr(), *K = parts_.K().valuePtr();
  double* S = S_.valuePtr();
  parts_.visit_columns([&](int first, int count, int begin, int rows) {
    if (count == 1) {
      for (int i = begin; i < begin + rows; ++i) S[i] = K[i] + c_C * C[i] + c_M * M[i];
      return;
    }
    using Block = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, n_node>>;
    const Twist<D> h_node = exponent.segment<n_node>(first);
    const TwistMatrix<D> T = right_tangent_inverse<D>(h_node);
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, n_node>>(S + begin, rows, n_node).noalias() =
        Block(K + begin, rows, n_node) +
        (c_C * Block(C + begin, rows, n_node) + c_M * Block(M + begin, rows, n_node)) * T;
  });
  if (!factor_.factor(S_)) {
    throw NotConverged("sensitivities: the tangent of a step is singular", state_.t, 0, 0);
  }
}

/// Memories of the laws after the step, by the laws' own rule for both values of each parameter.
template <int D>
void SensitivitiesIn<D>::remember(const StateD& before, const StateD& after) {
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
      const auto memory = [&](const SystemD& system, double amount) {
        joints::LawMemory old = before.laws[k];
        old.x += amount * before_.law_x(k, p);
        old.z += amount * before_.law_z(k, p);
        return joints::respond(system.laws()[k].law, x + amount * dx, x_dot + amount * dx_dot, old).z;
      };
      now_.law_x(k, p) = dx;
      if (joints::acts_at_rest(law.law)) continue;  // no memory
      const VariationIn<D>& varied = variations_[p];
      now_.law_z(k, p) =
          (memory(*varied.plus, varied.up) - memory(*varied.minus, varied.down)) / varied.spread();
    }
  }
}

template class SensitivitiesIn<2>;
template class SensitivitiesIn<3>;

}  // namespace flexarm::simulation
