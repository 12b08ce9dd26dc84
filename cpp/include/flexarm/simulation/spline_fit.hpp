/// @file
/// Cubic splines by least squares, their breaks among the samples. With B-splines B_j of which four are not
/// zero in an interval, s(t) = Σ c_j B_j(t), the coefficients of the least Σ (y_i − s(t_i))² follow from
///
///     Bᵀ B c = Bᵀ y,    B_ij = B_j(t_i)                                                               (1)
///
/// with Bᵀ B of half band width 3. B-splines of degree k follow from those of degree k − 1,
///
///     B_j^k(t) = w_j(t) B_j^{k−1}(t) + (1 − w_{j+1}(t)) B_{j+1}^{k−1}(t),                        (2)
///     w_j(t) = (t − t_j)/(t_{j+k} − t_j)
///
/// Source: [deBoor2001], chapters IX and XIV.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace flexarm::simulation {

using SampleRef = Eigen::Ref<const Eigen::VectorXd>;
/// m + 1 rising indices of samples, from the first to the last.
using BreakRef = Eigen::Ref<const Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>>;

/// Both sides of (1) for m intervals.
struct SplineEquations {
  /// (4, m + 3): the diagonal of Bᵀ B and the three below it, column by column.
  Eigen::MatrixXd band;
  Eigen::VectorXd right;
};

/// @param time n rising instants; @param values n samples; @param breaks where the third derivative may jump.
/// @throws InvalidParameter if sizes or breaks do not fit the samples.
SplineEquations spline_equations(const SampleRef& time, const SampleRef& values, const BreakRef& breaks);

/// s(t_i) at all samples, from m + 3 coefficients.
/// @throws InvalidParameter as above.
Eigen::VectorXd spline_values(const SampleRef& time, const BreakRef& breaks, const SampleRef& coefficients);

}  // namespace flexarm::simulation
