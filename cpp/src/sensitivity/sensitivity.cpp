#include "flexarm/sensitivity/sensitivity.hpp"

#include <algorithm>
#include <cmath>

#include "flexarm/errors.hpp"
#include "flexarm/simulation/sampled_run.hpp"

namespace flexarm::sensitivity {
namespace {

using namespace geometry;
using namespace simulation;

/// Constraints are scaled to the size of the diagonal, as in the stepper.
double largest_diagonal(const Eigen::SparseMatrix<double>& A, Eigen::Index n) {
  double largest = 0;
  for (Eigen::Index k = 0; k < n; ++k) largest = std::max(largest, std::abs(A.coeff(k, k)));
  return largest > 0 ? largest : 1.0;
}

template <int D>
std::vector<VariationIn<D>> checked(const assembly::SystemIn<D>& system,
                                    std::vector<VariationIn<D>> variations) {
  for (const VariationIn<D>& p : variations) p.check(system);
  return variations;
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

/// Whether nothing free has moved yet with any parameter.
bool rests(const StateDerivative& d, Eigen::Index n_free) {
  return d.position.topRows(n_free).isZero(0) && d.velocity.topRows(n_free).isZero(0) &&
         d.a.topRows(n_free).isZero(0) && d.v_dot.topRows(n_free).isZero(0) && d.multipliers.isZero(0);
}

}  // namespace

StateDerivative static_derivative(const System& system, const Equilibrium& equilibrium,
                                  const std::vector<Variation>& variations) {
  for (const Variation& p : variations) p.check(system);
  const State& state = equilibrium.state;
  StateDerivative d(system, static_cast<Eigen::Index>(variations.size()));
  PartialResidualsIn<3> partial(system, variations);
  partial.prescribe(state.t, d);
  d.velocity.setZero();  // at rest, however the drives begin
  d.v_dot.setZero();
  assembly::TangentPartsIn<3> parts(system);
  parts.assemble(state, equilibrium.loads, 1.0, false);
  const double scale = largest_diagonal(parts.K(), system.n_free());
  parts.assemble(state, equilibrium.loads, scale, false);
  linear_solvers::SparseFactor factor;
  if (!factor.factor(parts.K())) {
    throw NotConverged("derivative of an equilibrium: the stiffness matrix is singular", state.t, 0, 0);
  }
  LawSlopesIn<3> laws(system, variations);
  laws.evaluate(state, false);
  Slopes rhs;
  partial.evaluate(state, d, equilibrium.loads, laws, rhs);
  MatrixXd x = rhs;
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
SensitivitiesIn<D>::SensitivitiesIn(const SystemD& system, const integrators::HhtCoefficients& coefficients,
                                    std::vector<VariationIn<D>> variations, StateDerivative initial)
    : system_(system),
      coefficients_(coefficients),
      variations_(checked(system, std::move(variations))),
      laws_(system, variations_),
      partial_(system, variations_),
      now_(std::move(initial)),
      before_(now_),
      parts_(system),
      step_(system, coefficients) {}

template <int D>
void SensitivitiesIn<D>::follow(const StateD& before, const StateD& after, const VectorXd& exponent, double h,
                                const LoadsD& loads) {
  const bool at_rest = rests(now_, system_.n_free());
  std::swap(before_, now_);  // all free rows of now_ are written anew
  if (at_rest) now_ = before_;
  partial_.prescribe(after.t, now_);
  state_ = after;
  state_.laws = before.laws;  // with which the step was made
  now_.law_x = before_.law_x;
  now_.law_z = before_.law_z;
  laws_.evaluate(state_, true);
  const double scale = system_.mass() / (system_.n_nodes() * coefficients_.beta * h * h);
  partial_.evaluate(state_, now_, loads, laws_, rhs_);
  add_torques();
  if (at_rest && rhs_.isZero(0)) return remember();  // parameters of drives that come later
  rhs_.bottomRows(system_.n_constraints()) *= scale;
  parts_.assemble(state_, loads, scale, true);
  step_.prepare(exponent, h);
  step_.carry(before_, parts_, rhs_);
  factor();
  factor_.solve(rhs_);  // eq. (4)
  now_.multipliers = scale * rhs_.bottomRows(system_.n_constraints());
  step_.update(rhs_, now_);  // eq. (1) to (3)
  remember();
}

template <int D>
void SensitivitiesIn<D>::add_torques() {
  for (int s = 0; s < static_cast<int>(torques_.rows()); ++s) {
    if (system_.is_free(s)) rhs_.row(system_.scalar_offset() + s) += torques_.row(s);
  }
}

/// Equation (5).
template <int D>
void SensitivitiesIn<D>::factor() {
  step_.combine(parts_, S_);
  if (!factor_.factor(S_)) {
    throw NotConverged("sensitivities: the tangent of a step is singular", state_.t, 0, 0);
  }
}

/// Memories of the laws after the step.
template <int D>
void SensitivitiesIn<D>::remember() {
  const int offset = system_.scalar_offset();
  for (std::size_t k = 0; k < system_.laws().size(); ++k) {
    const auto& law = system_.laws()[k];
    const auto row = static_cast<Eigen::Index>(k);
    dx_ = now_.position.row(offset + law.plus);
    dx_dot_ = now_.velocity.row(offset + law.plus);
    if (law.minus >= 0) {
      dx_ -= now_.position.row(offset + law.minus);
      dx_dot_ -= now_.velocity.row(offset + law.minus);
    }
    now_.law_x.row(row) = dx_;
    if (!joints::acts_at_rest(law.law)) now_.law_z.row(row) = laws_.memory(k, before_, dx_, dx_dot_);
  }
}

template class SensitivitiesIn<2>;
template class SensitivitiesIn<3>;

}  // namespace flexarm::sensitivity
