/// @file
/// Turned joints of arms side by side: (2) and (5) of integrators/woodbury_update.hpp, without laws. Included
/// once for each kind of processor.
#pragma once

#include "flexarm/integrators/turned.hpp"
#include "flexarm/lanes/lane_pivots.hpp"
#include "flexarm/lanes/row_code.hpp"

namespace flexarm::lanes {

template <int D, int N, class Processor>
class TurnCode : protected RowCode<N, Processor> {
 protected:
  using Rows = RowCode<N, Processor>;
  using Rows::at, Rows::put, Rows::put_matrix;
  using typename Rows::Real;

  /// Factors of I + C G for the angles at hand, in the lanes that are chosen.
  static void prepare(const Turns& turns, const double* s, const Real& chosen) {
    const bool all = (0.5 - chosen).all_below(0);
    double* here = all ? turns.factors : turns.other_factors;
    const int m = turns.n_columns;
    for (int i = 0; i < turns.n_joints; ++i) {
      const double* own = turns.numbers + N * numbers * i;
      const Turned T = integrators::turned<D, Real>(
          matrix<Twist>(own, across * across), turns.joints[i].slides, at(s, turns.joints[i].coordinate));
      const Turned E = at(turns.scale, 0) * (matrix<Turned>(own, 0) - T);  // eq. (2)
      keep(turns.E, across * across * i, E.data(), across * across, chosen, all);
      for (int j = 0; j < m; ++j) {
        const auto G_node = matrix<Part>(turns.G, m * j + both * i),
                   G_row = matrix<Part>(turns.G, m * j + both * i + across);
        const Part on_node = E.transpose() * G_row, on_row = E * G_node;
        for (int k = 0; k < across; ++k) {
          put(here, m * (both * i + k) + j, on_node[k]);
          put(here, m * (both * i + across + k) + j, on_row[k]);
        }
      }
    }
    for (int k = 0; k < m; ++k) put(here, (m + 1) * k, 1 + at(here, (m + 1) * k));
    auto [A, pivots] = factors(here, m);
    linear_solvers::factor_in_place(A, pivots);
    if (!all) keep(turns.factors, 0, reinterpret_cast<const Real*>(here), m * m + 2 * m, chosen, false);
  }

  /// Uᵀ x.
  static void find_along(const Turns& turns, const double* x, double* along) {
    for (int i = 0; i < turns.n_joints; ++i) {
      const double* own = turns.numbers + N * (numbers * i + across * across + n);
      const Part on_node = matrix<Across>(own, 0).transpose() * matrix<Twist>(x, turns.joints[i].node),
                 on_row = matrix<RowAcross>(own, n * across).transpose() *
                          matrix<Multipliers>(x, turns.joints[i].multipliers);
      put_matrix(along, both * i, on_node);
      put_matrix(along, both * i + across, on_row);
    }
  }

  /// f of (5). @param along Uᵀ x
  static void find_forces(const Turns& turns, const double* along, double* f) {
    for (int i = 0; i < turns.n_joints; ++i) {
      const auto E = matrix<Turned>(turns.E, across * across * i);
      put_matrix(f, both * i, Part(E.transpose() * matrix<Part>(along, both * i + across)));
      put_matrix(f, both * i + across, Part(E * matrix<Part>(along, both * i)));
    }
    Eigen::Map<Eigen::Matrix<Real, Eigen::Dynamic, 1>> x(reinterpret_cast<Real*>(f), turns.n_columns);
    const auto [LU, pivots] = factors(turns.factors, turns.n_columns);
    linear_solvers::substitute(LU, pivots, x);
  }

 private:
  static constexpr int n = geometry::freedoms<D>, across = integrators::across_joint<D>, both = 2 * across;
  static constexpr int rows = integrators::rows_across<D>;
  static constexpr int numbers = across * across + n + (n + rows) * across;  // of a joint
  using Turned = integrators::Turned<D, Real>;
  using Twist = geometry::Twist<D, Real>;
  using Part = Eigen::Matrix<Real, across, 1>;
  using Across = Eigen::Matrix<Real, n, across>;
  using RowAcross = Eigen::Matrix<Real, rows, across>;
  using Multipliers = Eigen::Matrix<Real, rows, 1>;
  using Square = Eigen::Map<Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

  struct Factors {
    Square A;
    LanePivots<Real> pivots;
  };
  static Factors factors(double* rows, int m) {
    Real* first = reinterpret_cast<Real*>(rows);
    return {Square(first, m, m), {first + m * m, first + m * m + m}};
  }

  /// Writes rows in the chosen lanes.
  static void keep(double* rows, int k, const Real* found, int count, const Real& chosen, bool all) {
    for (int i = 0; i < count; ++i) {
      put(rows, k + i, all ? found[i] : found[i].where(chosen) + at(rows, k + i).where(1 - chosen));
    }
  }
};

}  // namespace flexarm::lanes
