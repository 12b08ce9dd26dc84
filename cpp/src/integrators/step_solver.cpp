#include "flexarm/integrators/step_solver.hpp"

#include "flexarm/errors.hpp"

namespace flexarm::integrators {

template <int D>
StepSolverIn<D>::StepSolverIn(const SystemIn<D>& system, const HhtCoefficients& coefficients,
                              const HhtOptions& options)
    : system_(system),
      coefficients_(coefficients),
      reproducible_(options.reproducible),
      scale_(constraint_scale(system)),
      matrix_(system),
      condensation_(system, options.condense),
      update_(system, condensation_),
      dx_(system.n_unknowns()),
      reduced_(condensation_.n_unknowns()) {}

template <int D>
bool StepSolverIn<D>::factor(const StateIn<D>& state, const LoadsIn<D>& loads, double h) {
  const assembly::TangentFactors c = step_factors(coefficients_, h, scale_);
  const VectorXd law_tangents = system_.law_tangents(state, c, true);
  if (reproducible_) {  // neither the pattern nor the pivots of earlier numbers
    factored_ = std::make_shared<const LinearisationIn<D>>(state, loads, h);
    matrix_.forget();
    factor_ = linear_solvers::CachedFactorisation();
  }
  const Eigen::SparseMatrix<double>* S = matrix_.assemble(state, loads, c, law_tangents);
  singular_ = S == nullptr || !factor_.factor(condensation_.any() ? condensation_.reduce(*S) : *S);
  factored_h_ = singular_ ? 0 : h;
  if (!singular_) update_.keep(state, c, law_tangents, factor_.by_substitution());
  return !singular_;
}

template <int D>
void StepSolverIn<D>::recall(const std::shared_ptr<const LinearisationIn<D>>& factored) {
  if (factored_h_ != 0 && factored == factored_) return;
  forget_factors();
  if (factored == nullptr) return;
  if (!factor(factored->state, factored->loads, factored->h)) {
    throw NotConverged(
        "the matrix that was factored at t = " + std::to_string(factored->state.t) + " s is singular",
        factored->state.t, 0, 0);
  }
  factored_ = factored;
}

template <int D>
const VectorXd& StepSolverIn<D>::solve(const StateIn<D>& state, const VectorXd& r, const VectorXd& phi,
                                       double h, bool again) {
  const int n = system_.n_free(), n_constraints = system_.n_constraints();
  dx_.head(n) = -r.head(n);
  dx_.tail(n_constraints) = -scale_ / (coefficients_.beta * h * h) * phi;
  if (condensation_.any()) {
    condensation_.condense(dx_, reduced_);
    factor_.solve(reduced_);
    update_.correct(state, reduced_, again);
    condensation_.expand(reduced_, dx_);
  } else {
    factor_.solve(dx_);
    update_.correct(state, dx_, again);
  }
  dx_.tail(n_constraints) *= scale_ * (1 / (coefficients_.beta * h * h));
  return dx_;
}

template class StepSolverIn<2>;
template class StepSolverIn<3>;

}  // namespace flexarm::integrators
