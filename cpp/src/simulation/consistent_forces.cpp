#include "flexarm/simulation/consistent_forces.hpp"

#include "flexarm/assembly/constraint_forces.hpp"
#include "flexarm/errors.hpp"
#include "flexarm/integrators/hht_coefficients.hpp"

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
ConsistentForcesIn<D>::ConsistentForcesIn(const assembly::SystemIn<D>& system, std::size_t most_joints)
    : system_(system),
      scale_(integrators::constraint_scale(system)),
      matrix_(system),
      none_(system, false),
      update_(system, none_, false, most_joints),
      c_(system.n_constraints()),
      change_(VectorXd::Zero(system.n_unknowns())),
      r_(system.n_velocities()),
      phi_(system.n_constraints()) {}

/// M is constant in the axes of the nodes.
template <int D>
void ConsistentForcesIn<D>::find_masses(const assembly::StateIn<D>& state) {
  mass_ = system_.tangent(state, {}, {1, 0, 0}, false);
  const VectorXd diagonal = mass_.diagonal();
  massless_.resize(system_.n_unknowns(), system_.n_unknowns());
  for (Eigen::Index k = 0; k < diagonal.size(); ++k) {
    if (diagonal[k] != 0) continue;
    const double part = nearly_massless * diagonal.maxCoeff();
    massless_.insert(k, k) = part;
    mass_.coeffRef(k, k) += part;
  }
  mass_.prune(0.0);
}

template <int D>
void ConsistentForcesIn<D>::factor(const assembly::StateIn<D>& state) {
  if (massless_.size() == 0) find_masses(state);
  const Eigen::SparseMatrix<double>& A = masses_and_constraints(system_, matrix_, state, scale_);
  const bool all_massive = massless_.nonZeros() == 0;
  factored_ = kept_.factor(all_massive ? A : (regular_ = A + massless_));
  if (!factored_) {
    throw NotConverged("forces of the joints: the matrix of masses and constraints is singular", state.t, 0,
                       0);
  }
  const VectorXd no_laws = system_.no_law_tangents();
  update_.keep(state, {1, 0, 0, scale_}, no_laws, kept_.by_substitution());
  if (kept_.inverse() == nullptr) return;
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(system_.n_unknowns(), system_.n_constraints());
  columns.bottomRows(columns.cols()).diagonal().setConstant(-scale_);
  kept_.by_substitution().solve(columns);
  by_constraints_ = linear_solvers::PackedMatrix(columns);
  padded_.resize(by_constraints_.filled_rows());
}

/// x := A₀⁻¹ x with the joints that turned since. @param again in this state
template <int D>
void ConsistentForcesIn<D>::substitute(const assembly::StateIn<D>& state, VectorXd& x, bool again) {
  kept_.solve(x);
  update_.correct(state, x, again);
}

/// `product` := A x. Accelerations of the constraints are linear where `still` does not move.
template <int D>
void ConsistentForcesIn<D>::multiply(assembly::StateIn<D>& still, const VectorXd& x, VectorXd& product) {
  const auto w = x.head(system_.n_free());
  multipliers_ = scale_ * x.tail(c_.size());
  r_.setZero();
  assembly::add_constraint_forces_on_nodes(system_, still, multipliers_, r_);
  assembly::add_constraint_forces_on_scalars<D>(system_, still, multipliers_, r_.tail(system_.n_scalars()));
  still.v_dot.head(w.size()) = w;
  system_.constraint_acceleration(still, c_);
  product.head(w.size()) = mass_ * w + r_.head(w.size());
  product.tail(c_.size()) = scale_ * c_;
}

/// Equation (3). @return false where it contracts slowly
template <int D>
bool ConsistentForcesIn<D>::refine(const assembly::StateIn<D>& state, const VectorXd& b, VectorXd& x) {
  VectorXd dx(x.size());
  still_ = state;
  still_.v.setZero();
  still_.v_dot.setZero();
  double last = x.norm();
  const double tolerance = refined * (1 + last);
  for (int k = 0; k < most_refinements; ++k) {
    multiply(still_, x, dx);
    dx = b - dx;
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
  if (update_.follows_constraints()) {
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

/// change_ := the right side of (2), with r where it is more than rounding.
template <int D>
void ConsistentForcesIn<D>::find_sides(const assembly::StateIn<D>& state, const assembly::LoadsIn<D>* loads) {
  change_.setZero();
  change_.tail(c_.size()) = -scale_ * c_;
  if (loads == nullptr || update_.follows_constraints()) return;
  system_.evaluate(state, *loads, r_, phi_);
  change_.head(system_.n_free()) = -r_.head(system_.n_free());
}

template <int D>
const assembly::StateIn<D>& ConsistentForcesIn<D>::of(const assembly::StateIn<D>& state,
                                                      const assembly::LoadsIn<D>* loads) {
  system_.constraint_acceleration(state, c_);
  if (c_.isZero(0)) {
    change_.setZero();
    return state;  // at rest
  }
  if (!factored_) factor(state);
  if (update_.follows_constraints() && by_constraints_.cols() > 0) {
    by_constraints_.multiply(c_.data(), padded_.data());
    change_ = padded_.head(change_.size());
    update_.correct(state, change_);
  } else {
    find_sides(state, loads);
    solve(state, change_);  // eq. (2)
  }
  consistent_ = state;
  consistent_.v_dot.head(system_.n_free()) += change_.head(system_.n_free());
  consistent_.multipliers += scale_ * change_.tail(c_.size());
  return consistent_;
}

/// Nodes whose frames the constraints depend on.
template <int D>
std::vector<int> constrained_nodes(const assembly::SystemIn<D>& system) {
  std::vector<bool> constrained(static_cast<std::size_t>(system.n_nodes()), !system.closures().empty());
  for (const auto& joint : system.constraints()) {
    for (const int node : {joint.node_a(), joint.node_b()}) {
      if (node >= 0) constrained[static_cast<std::size_t>(node)] = true;
    }
  }
  std::vector<int> nodes;
  for (int node = 0; node < system.n_nodes(); ++node) {
    if (constrained[static_cast<std::size_t>(node)]) nodes.push_back(node);
  }
  return nodes;
}

template <int D>
ConsistentForceSlopesIn<D>::ConsistentForceSlopesIn(const assembly::SystemIn<D>& system,
                                                    const std::vector<VariationIn<D>>& variations)
    : system_(system),
      variations_(variations),
      nodes_(constrained_nodes(system)),
      forces_(system),
      multipliers_(system.n_constraints()),
      r_(system.n_velocities()),
      c_(system.n_constraints()) {}

/// Masses in the axes of the nodes are constant, so that one state gives their derivatives.
template <int D>
void ConsistentForceSlopesIn<D>::find_mass_slopes(const assembly::StateIn<D>& state) {
  const auto mass = [&](const assembly::SystemIn<D>& model) {
    return model.tangent(state, {}, {1, 0, 0}, false);
  };
  for (const VariationIn<D>& p : variations_) {
    mass_slopes_.push_back((mass(*p.plus) - mass(*p.minus)) / p.spread());
    mass_slopes_.back().prune(0.0);
  }
}

/// Takes the constrained nodes and the scalar coordinates of `there` from `state` along column k.
template <int D>
void ConsistentForceSlopesIn<D>::move(const assembly::StateIn<D>& state, const StateDerivative& derivative,
                                      Eigen::Index k, double amount, assembly::StateIn<D>& there) const {
  constexpr int n = geometry::freedoms<D>;
  const auto position = derivative.position.col(k), velocity = derivative.velocity.col(k),
             v_dot = derivative.v_dot.col(k);
  const auto rates = [&](Eigen::Index first, Eigen::Index size) {
    there.v.segment(first, size) = state.v.segment(first, size) + amount * velocity.segment(first, size);
    there.v_dot.segment(first, size) = state.v_dot.segment(first, size) + amount * v_dot.segment(first, size);
  };
  for (const int node : nodes_) {
    const geometry::Twist<D> h = amount * position.template segment<n>(n * node);
    there.frames[node] = state.frames[node] * geometry::exponential<D>(h);
    rates(n * node, n);
  }
  there.s = state.s + amount * position.tail(system_.n_scalars());
  rates(system_.scalar_offset(), system_.n_scalars());
}

/// Φ_qᵀ (λ̃ − λ), and c with w.
template <int D>
void ConsistentForceSlopesIn<D>::constrain(const assembly::SystemIn<D>& model,
                                           const assembly::StateIn<D>& state, double factor, VectorXd& x) {
  r_.setZero();
  assembly::add_constraint_forces_on_nodes(model, state, multipliers_, r_);
  assembly::add_constraint_forces_on_scalars<D>(model, state, multipliers_, r_.tail(model.n_scalars()));
  model.constraint_acceleration(state, c_);
  x.head(model.n_free()) += factor * r_.head(model.n_free());
  x.tail(c_.size()) += factor * forces_.scale() * c_;
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
  if (mass_slopes_.empty()) find_mass_slopes(state);
  const auto dw = forces_.change().head(system_.n_free());
  multipliers_ = forces_.scale() * forces_.change().tail(system_.n_constraints());
  moved_ = *state_;
  for (Eigen::Index k = 0; k < derivative.size(); ++k) {
    if (!moves(derivative, k)) continue;
    const VariationIn<D>& p = variations_[static_cast<std::size_t>(k)];
    x_.setZero(system_.n_unknowns());
    move(*state_, derivative, k, p.up, moved_);
    constrain(*p.plus, moved_, -1 / p.spread(), x_);
    move(*state_, derivative, k, p.down, moved_);
    constrain(*p.minus, moved_, 1 / p.spread(), x_);
    x_.head(system_.n_free()) -= mass_slopes_[static_cast<std::size_t>(k)] * dw;
    forces_.solve(state, x_);
    derivative_.v_dot.col(k).head(system_.n_free()) += x_.head(system_.n_free());
    derivative_.multipliers.col(k) += forces_.scale() * x_.tail(system_.n_constraints());
  }
}

template class ConsistentForcesIn<2>;
template class ConsistentForcesIn<3>;
template class ConsistentForceSlopesIn<2>;
template class ConsistentForceSlopesIn<3>;

}  // namespace flexarm::simulation
