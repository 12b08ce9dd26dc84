/// @file
/// A parameter of a model, varied a little up and a little down.
///
/// Two systems of one structure, assembled with p + δ and p − δ, give the derivative of whatever is evaluated
/// in a state x whose own derivative dx/dp is known,
///
///     df/dp ≈ (f(x + δ dx/dp; p + δ) − f(x − δ dx/dp; p − δ))/(2 δ),                                 (1)
///
/// with an error of δ² from the third derivative and of 1e-16/δ from rounding: nine digits where δ is near
/// 3e-5 of the parameter, since residuals and outputs are polynomials of low degree in nearly every
/// parameter.
#pragma once

#include "flexarm/assembly/system.hpp"
#include "flexarm/integrators/hht.hpp"

namespace flexarm::simulation {

using assembly::Loads;
using assembly::State;
using assembly::System;
using Eigen::MatrixXd;
using Eigen::VectorXd;

template <int D>
struct VariationIn {
  const assembly::SystemIn<D>* plus;
  const assembly::SystemIn<D>* minus;
  double up, down;  ///< p⁺ − p >= 0 and p⁻ − p <= 0; one of them 0 where p is at its limit
  integrators::Drives drive_plus, drive_minus;  ///< empty where the drives do not depend on p

  double spread() const { return up - down; }
  /// @throws InvalidParameter unless both systems have the structure of `system`.
  void check(const assembly::SystemIn<D>& system) const;
};
using Variation = VariationIn<3>;

/// Derivatives of quantities (rows) by parameters (columns), stored by rows: loops run over the parameters.
using Slopes = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// dx/dp of a State, one column a parameter. Rows of nodes hold the twist by which their frames move, in
/// their own axes; prescribed coordinates have rows too.
struct StateDerivative {
  Slopes position, velocity, v_dot, a;  ///< n_velocities() rows
  Slopes multipliers;                   ///< n_constraints() rows
  Slopes law_x, law_z;                  ///< memories of the laws

  StateDerivative() = default;
  template <int D>
  StateDerivative(const assembly::SystemIn<D>& system, Eigen::Index n_parameters);  ///< zero
  Eigen::Index size() const { return position.cols(); }
};

/// The state moved along its derivative by `amount` of the k-th parameter.
template <int D>
assembly::StateIn<D> moved(const assembly::SystemIn<D>& system, const assembly::StateIn<D>& state,
                           const StateDerivative& derivative, Eigen::Index k, double amount);

}  // namespace flexarm::simulation
