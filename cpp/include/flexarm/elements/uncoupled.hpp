/// @file
/// The pattern of a straight beam's matrices: of two twists at its ends stretch, twist and the two planes of
/// bending do not couple. In a plane (D = 2) stretch and one plane of bending are left.
#pragma once

#include <Eigen/Core>
#include <array>

#include "flexarm/geometry/twist.hpp"

namespace flexarm::elements {

/// Two nodes' twists, one after the other.
template <int D>
using TwoTwists = Eigen::Matrix<double, 2 * geometry::freedoms<D>, 1>;
template <int D>
using TwoTwistsMatrix = Eigen::Matrix<double, 2 * geometry::freedoms<D>, 2 * geometry::freedoms<D>>;
using Matrix12d = TwoTwistsMatrix<3>;
using Vector12d = TwoTwists<3>;

/// What a straight beam does not couple: stretch, twist and the two planes of bending.
template <int D>
struct Uncoupled {
  static constexpr int n = geometry::freedoms<D>;
  template <class Real>
  using Ends = Eigen::Matrix<Real, 2 * n, 1>;

  /// Components of a twist that stand alone, and those of each bending plane: w₁, θ₁, w₂, θ₂ of two twists.
  using Bending = std::array<int, 4>;
  static constexpr auto alone = [] {
    if constexpr (D == 2) return std::array{0};
    if constexpr (D == 3) return std::array{0, 3};
  }();
  static constexpr auto bending = [] {
    if constexpr (D == 2) return std::array<Bending, 1>{{{1, 2, 4, 5}}};
    if constexpr (D == 3) return std::array<Bending, 2>{{{1, 5, 7, 11}, {2, 4, 8, 10}}};
  }();

  /// M v of a matrix with such zeros.
  template <class Real>
  static Ends<Real> product(const Eigen::Matrix<Real, 2 * n, 2 * n>& M, const Ends<Real>& v) {
    Ends<Real> p;
    for (int k : alone) {
      p[k] = M(k, k) * v[k] + M(k, k + n) * v[k + n];
      p[k + n] = M(k + n, k) * v[k] + M(k + n, k + n) * v[k + n];
    }
    for (const auto& plane : bending) {
      for (int row : plane) {
        p[row] = M(row, plane[0]) * v[plane[0]] + M(row, plane[1]) * v[plane[1]] +
                 M(row, plane[2]) * v[plane[2]] + M(row, plane[3]) * v[plane[3]];
      }
    }
    return p;
  }
};

}  // namespace flexarm::elements
