/// @file
/// Cubic spline through exact samples, twice continuously differentiable. With steps h_k = x_{k+1} − x_k,
/// difference quotients δ_k = (y_{k+1} − y_k)/h_k and slopes d_k at the samples, equal second derivatives on
/// both sides of an inner sample ask for
///
///     h_k d_{k−1} + 2 (h_{k−1} + h_k) d_k + h_{k−1} d_{k+1} = 3 (h_k δ_{k−1} + h_{k−1} δ_k)          (1)
///
/// and the not-a-knot condition at both ends: the third derivative is continuous at the second sample,
///
///     h_1 d_0 + (h_0 + h_1) d_1 = [(3 h_0 + 2 h_1) h_1 δ_0 + h_0² δ_1]/(h_0 + h_1)                   (2)
///
/// and at the penultimate one likewise. On an interval, with x from its start,
///
///     s(x) = y_k + d_k x + (3 δ_k − 2 d_k − d_{k+1})/h_k x² + (d_k + d_{k+1} − 2 δ_k)/h_k² x³          (3)
///
/// Source: [deBoor2001], chapter IV.
#pragma once

#include <Eigen/Core>

namespace flexarm::simulation {

/// Coefficients (3), as PiecewisePolynomial takes them: (4, n − 1), highest power first. Two samples are
/// joined by a line, three by a parabola.
/// @param x n rising instants; @param y n values; units are those of x and y.
/// @throws InvalidParameter if there are fewer than two samples, sizes differ, a value is not finite or x
/// does not rise.
Eigen::MatrixXd cubic_spline(const Eigen::VectorXd& x, const Eigen::VectorXd& y);

}  // namespace flexarm::simulation
