/// @file
/// Interpolation of a simulated motion between its steps. In a step h from t_k to t_{k+1}, with t from t_k,
/// values x and rates v,
///
///     x(t) = x_k + v_k t + (3 δ − 2 v_k − v_{k+1})/h t² + (v_k + v_{k+1} − 2 δ)/h² t³            (1)
///
/// with δ = (x_{k+1} − x_k)/h. Without rates v are differences, central and exact of a parabola, one-sided at
/// both ends.
#pragma once

#include <Eigen/Core>

namespace flexarm::simulation {

using SampledValues = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using SampledRef = Eigen::Ref<const SampledValues>;
using InstantRef = Eigen::Ref<const Eigen::VectorXd>;

/// Values (m, k) at m instants, by (1), of a motion with values and rates (n, k), or no rates, at n rising
/// times. Before the first step it stands at its first value, for up to `early` [s] with its first rate if
/// rates are given; after the last step nothing is known (NaN).
/// @throws InvalidParameter if sizes differ, or there is no step.
SampledValues sample_motion(const InstantRef& time, const SampledRef& values, const SampledRef& rates,
                            const InstantRef& instants, double early);

}  // namespace flexarm::simulation
