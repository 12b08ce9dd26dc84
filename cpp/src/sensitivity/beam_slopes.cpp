#include "flexarm/sensitivity/beam_slopes.hpp"

#include "flexarm/simd/columns.hpp"

namespace flexarm::sensitivity {
namespace {

using namespace geometry;
using namespace simulation;
using simd::columns_at_a_time;
using simd::lanes;
using simd::Lanes;
using simd::work_through;

/// Equations (1) and (2) for some parameters.
template <int D>
struct Stressing {
  const double *by_strain, *by_rate, *at_rest;
  const double *e, *e_dot, *to_ends;  // the latter column after column
  double* forces;
  Eigen::Index m;

  template <int N>
  [[gnu::always_inline]] void columns(Eigen::Index p) {
    constexpr int n = freedoms<D>;
    typename Lanes<N>::type stress[n];
    for (int i = 0; i < n; ++i) {
      const Eigen::Index at = i * m + p;
      stress[i] =
          lanes<N>(at_rest + at) + (e[i] * lanes<N>(by_strain + at) + e_dot[i] * lanes<N>(by_rate + at));
    }
    for (int i = 0; i < 2 * n; ++i) {
      typename Lanes<N>::type force = to_ends[i] * stress[0];
      for (int j = 1; j < n; ++j) force += to_ends[2 * n * j + i] * stress[j];
      lanes<N>(forces + i * m + p) = force;
    }
  }
};

/// Equation (3) for some parameters.
template <int D>
struct Accelerating {
  const MassSlopes::Entry* entries;
  std::size_t n_entries;
  const double *mass, *v, *v_dot;
  const double* turn;  // ad(v)ᵀ of both ends, column after column
  double* forces;
  Eigen::Index m;

  template <int N>
  [[gnu::always_inline]] void columns(Eigen::Index p) {
    using Lane = typename Lanes<N>::type;
    constexpr int n = freedoms<D>;
    std::size_t k = 0;
    for (int end = 0; end < 2; ++end, turn += n * n) {
      Lane momentum[n], force[n];
      for (int i = 0; i < n; ++i) {
        momentum[i] = force[i] = Lane{};
        for (; k < n_entries && entries[k].row == n * end + i; ++k) {
          const Lane& of = lanes<N>(mass + static_cast<Eigen::Index>(k) * m + p);
          momentum[i] += v[entries[k].column] * of;
          force[i] += v_dot[entries[k].column] * of;
        }
      }
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) force[i] -= turn[n * j + i] * momentum[j];
        lanes<N>(forces + (n * end + i) * m + p) = force[i];
      }
    }
    turn -= 2 * n * n;
  }
};

}  // namespace

template <int D>
void stress_forces(const StressSlopes& slopes, const Twist<D>& e, const Twist<D>& e_dot,
                   const Eigen::Matrix<double, 2 * freedoms<D>, freedoms<D>>& to_ends, Slopes& forces) {
  const Eigen::Index m = slopes.by_strain.cols();
  forces.resize(2 * freedoms<D>, m);
  work_through<columns_at_a_time<D>>(
      Stressing<D>{slopes.by_strain.data(), slopes.by_rate.data(), slopes.at_rest.data(), e.data(),
                   e_dot.data(), to_ends.data(), forces.data(), m},
      m);
}

template <int D>
void inertia_forces(const MassSlopes& slopes, const elements::TwoTwists<D>& v,
                    const elements::TwoTwists<D>& v_dot, Slopes& forces) {
  constexpr int n = freedoms<D>;
  const Eigen::Index m = slopes.mass.cols();
  Eigen::Matrix<double, n, 2 * n> turn;
  turn << ad<D>(v.template head<n>()).transpose(), ad<D>(v.template tail<n>()).transpose();
  forces.resize(2 * n, m);
  work_through<columns_at_a_time<D>>(
      Accelerating<D>{slopes.entries.data(), slopes.entries.size(), slopes.mass.data(), v.data(),
                      v_dot.data(), turn.data(), forces.data(), m},
      m);
}

template void stress_forces<2>(const StressSlopes&, const Twist<2>&, const Twist<2>&,
                               const Eigen::Matrix<double, 6, 3>&, Slopes&);
template void stress_forces<3>(const StressSlopes&, const Twist<3>&, const Twist<3>&,
                               const Eigen::Matrix<double, 12, 6>&, Slopes&);
template void inertia_forces<2>(const MassSlopes&, const elements::TwoTwists<2>&,
                                const elements::TwoTwists<2>&, Slopes&);
template void inertia_forces<3>(const MassSlopes&, const elements::TwoTwists<3>&,
                                const elements::TwoTwists<3>&, Slopes&);

}  // namespace flexarm::sensitivity
