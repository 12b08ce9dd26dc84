#include "flexarm/simulation/consistent_forces.hpp"

#include "flexarm/errors.hpp"
#include "flexarm/solvers/step_matrix.hpp"

namespace flexarm::simulation {
namespace {

// Refinement ends at this part of the solution and of 1 m/s²; A is factored anew above this rate, or after so
// many steps.
constexpr double refined = 1e-10, slow_contraction = 0.25;
constexpr int most_refinements = 8;

template <int D>
const Eigen::SparseMatrix<double>& masses_and_constraints(const assembly::SystemIn<D>& system,
                                                          assembly::IterationMatrixIn<D>& matrix,
                                                          const assembly::StateIn<D>& state, double scale) {
  const assembly::TangentFactors mass{1, 0, 0, scale};
  const VectorXd no_laws = system.no_law_tangents();
  const Eigen::SparseMatrix<double>* A = matrix.assemble(state, {}, mass, no_laws);
  if (A == nullptr) throw NotConverged("forces of the joints: a mass is not finite", state.t, 0, 0);
  return *A;
}

}  // namespace

template <int D>
ConsistentForcesIn<D>::ConsistentForcesIn(const assembly::SystemIn<D>& system)
    : system_(system),
      scale_(solvers::constraint_scale(system)),
      matrix_(system),
      none_(system, false),
      changes_(system, none_, false),
      c_(system.n_constraints()),
      change_(VectorXd::Zero(system.n_unknowns())),
      r_(system.n_velocities()),
      phi_(system.n_constraints()) {}

template <int D>
void ConsistentForcesIn<D>::find_massless(const assembly::StateIn<D>& state) {
  const VectorXd mass = system_.tangent(state, {}, {1, 0, 0}, false).diagonal();
  const double largest = mass.head(system_.n_free()).maxCoeff();
  massless_.resize(system_.n_unknowns(), system_.n_unknowns());
  for (Eigen::Index k = 0; k < mass.size(); ++k) {
    if (mass[k] == 0) massless_.insert(k, k) = nearly_massless * largest;
  }
}

template <int D>
void ConsistentForcesIn<D>::factor(const assembly::StateIn<D>& state) {
  if (massless_.size() == 0) find_massless(state);
  const Eigen::SparseMatrix<double>& A = masses_and_constraints(system_, matrix_, state, scale_);
  const bool all_massive = massless_.nonZeros() == 0;
  factored_ = kept_.factor(all_massive ? A : (regular_ = A + massless_));
  if (!factored_) {
    throw NotConverged("forces of the joints: the matrix of masses and constraints is singular", state.t, 0,
                       0);
  }
  const VectorXd no_laws = system_.no_law_tangents();
  changes_.keep(state, {1, 0, 0, scale_}, no_laws, kept_.by_substitution());
}

/// x := A₀⁻¹ x with the joints that turned since. @param again in this state
template <int D>
void ConsistentForcesIn<D>::substitute(const assembly::StateIn<D>& state, VectorXd& x, bool again) {
  kept_.solve(x);
  changes_.correct(state, x, again);
}

/// Equation of motion and accelerations of the constraints, linear in v̇ and λ by A.
template <int D>
void ConsistentForcesIn<D>::evaluate(const assembly::StateIn<D>& state, VectorXd& sides) {
  system_.evaluate(state, {}, r_, phi_);
  system_.constraint_acceleration(state, c_);
  sides.head(system_.n_free()) = r_.head(system_.n_free());
  sides.tail(c_.size()) = scale_ * c_;
}

/// Equation (3). @return false where it contracts slowly
template <int D>
bool ConsistentForcesIn<D>::refine(const assembly::StateIn<D>& state, const VectorXd& b, VectorXd& x) {
  VectorXd here(x.size()), dx(x.size());
  evaluate(state, here);
  double last = x.norm();
  const double tolerance = refined * (1 + last);
  for (int k = 0; k < most_refinements; ++k) {
    moved_ = state;
    moved_.v_dot.head(system_.n_free()) += x.head(system_.n_free());
    moved_.multipliers += scale_ * x.tail(c_.size());
    evaluate(moved_, dx);
    dx = b - (dx - here) - massless_ * x;
    substitute(state, dx, true);
    const double size = dx.norm();
    x += dx;
    if (size < tolerance) return true;
    if (size > slow_contraction * last) return false;
    last = size;
  }
  return false;
}

template <int D>
void ConsistentForcesIn<D>::solve(const assembly::StateIn<D>& state, VectorXd& x) {
  if (!factored_) factor(state);
  if (changes_.follows_constraints()) {
    substitute(state, x);
    return;
  }
  const VectorXd b = x;
  substitute(state, x);
  if (refine(state, b, x)) return;
  factor(state);
  x = b;
  substitute(state, x);
}

template <int D>
const assembly::StateIn<D>& ConsistentForcesIn<D>::of(const assembly::StateIn<D>& state,
                                                      const assembly::LoadsIn<D>* loads) {
  system_.constraint_acceleration(state, c_);
  change_.setZero();
  if (c_.isZero(0)) return state;  // at rest
  if (loads != nullptr && !changes_.follows_constraints()) {
    system_.evaluate(state, *loads, r_, phi_);
    change_.head(system_.n_free()) = -r_.head(system_.n_free());
  }
  change_.tail(c_.size()) = -scale_ * c_;
  solve(state, change_);  // eq. (2)
  consistent_ = state;
  consistent_.v_dot.head(system_.n_free()) += change_.head(system_.n_free());
  consistent_.multipliers += scale_ * change_.tail(c_.size());
  return consistent_;
}

template <int D>
ConsistentForceSlopesIn<D>::ConsistentForceSlopesIn(const assembly::SystemIn<D>& system,
                                                    const std::vector<VariationIn<D>>& variations)
    : system_(system),
      variations_(variations),
      forces_(system),
      with_(system.n_velocities()),
      without_(system.n_velocities()),
      phi_(system.n_constraints()),
      c_(system.n_constraints()) {}

/// Equation (1) of assembly/equations.hpp with and without the change: nothing but masses and constraints is
/// left.
template <int D>
VectorXd ConsistentForceSlopesIn<D>::evaluate(const assembly::SystemIn<D>& model,
                                              assembly::StateIn<D> state) {
  VectorXd sides(model.n_unknowns());
  auto c = sides.tail(model.n_constraints());
  model.constraint_acceleration(state, c_);
  model.evaluate(state, {}, with_, phi_);
  state.v_dot.head(model.n_free()) -= forces_.change().head(model.n_free());
  state.multipliers -= forces_.scale() * forces_.change().tail(model.n_constraints());
  model.evaluate(state, {}, without_, phi_);
  sides.head(model.n_free()) = (with_ - without_).head(model.n_free());
  c = forces_.scale() * c_;  // Φ_q (w − v̇) is part of it, for the state has w
  return sides;
}

/// False for the columns of parameters that the motion does not depend on, such as places of sensors.
bool moves(const StateDerivative& derivative, Eigen::Index k) {
  return !derivative.position.col(k).isZero(0) || !derivative.v_dot.col(k).isZero(0) ||
         !derivative.multipliers.col(k).isZero(0);
}

template <int D>
void ConsistentForceSlopesIn<D>::find(const assembly::StateIn<D>& state, const assembly::LoadsIn<D>& loads,
                                      const StateDerivative& derivative) {
  state_ = &forces_.of(state, &loads);
  derivative_ = derivative;
  if (state_ == &state || derivative.size() == 0) return;
  for (Eigen::Index k = 0; k < derivative.size(); ++k) {
    if (!moves(derivative, k)) continue;
    const VariationIn<D>& p = variations_[static_cast<std::size_t>(k)];
    VectorXd x = (evaluate(*p.minus, moved(system_, *state_, derivative, k, p.down)) -
                  evaluate(*p.plus, moved(system_, *state_, derivative, k, p.up))) /
                 p.spread();
    forces_.solve(state, x);
    derivative_.v_dot.col(k).head(system_.n_free()) += x.head(system_.n_free());
    derivative_.multipliers.col(k) += forces_.scale() * x.tail(system_.n_constraints());
  }
}

template class ConsistentForcesIn<2>;
template class ConsistentForcesIn<3>;
template class ConsistentForceSlopesIn<2>;
template class ConsistentForceSlopesIn<3>;

}  // namespace flexarm::simulation
