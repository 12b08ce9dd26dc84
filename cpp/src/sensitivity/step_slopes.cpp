#include "flexarm/sensitivity/step_slopes.hpp"

#include "flexarm/simd/columns.hpp"

namespace flexarm::sensitivity {
namespace {

using namespace geometry;
using namespace simulation;
using simd::columns_at_a_time;
using simd::lanes;
using simd::Lanes;
using simd::work_through;

/// Factors of (1) to (3). They are divisions, and the compiler cannot know that they stay while rows are
/// written.
struct Factors {
  double h, a_xi, a_a0, v_a0, v_a, alpha, v_dot_a;  // of state 0
  double a, v, v_dot;                               // of ξ₁

  Factors(const integrators::HhtCoefficients& c, double step)
      : h(step),
        a_xi(-1 / (c.beta * h * h)),
        a_a0(-(0.5 - c.beta) / c.beta),
        v_a0(h * (1 - c.gamma)),
        v_a(h * c.gamma),
        alpha(c.alpha),
        v_dot_a(1 / (1 + c.alpha)),
        a(1 / (c.beta * h * h)),
        v(c.gamma / (c.beta * h)),
        v_dot(a / (1 + c.alpha)) {}
};

/// Rows of derivatives, m numbers each.
struct StepRows {
  const double *position, *velocity, *v_dot, *a;
};

/// Equations (1), (2) and C v* + M v̇* for some parameters.
template <int D>
struct Carrying {
  Factors c;
  const assembly::TangentPartsIn<D>& parts;
  int n_nodes, n_free;
  const double* left;  // T_l⁻¹ of each node, column after column
  StepRows before;
  double *a, *v, *v_dot, *rhs;
  Eigen::Index m;

  template <int N>
  [[gnu::always_inline]] void columns(Eigen::Index p) {
    const int* start = parts.K().outerIndexPtr();
    constexpr int n = freedoms<D>;
    for (int k = 0; k < n_nodes; ++k) group<n, N>(n * k, left + n * n * k, start[n * k], p);
    for (int j = n * n_nodes; j < n_free; ++j) group<1, N>(j, nullptr, start[j], p);
  }

  /// Columns from `first` on that share their rows, those of a node or a scalar coordinate's own.
  template <int Count, int N>
  [[gnu::always_inline]] void group(int first, const double* T, int begin, Eigen::Index p) {
    using Lane = typename Lanes<N>::type;
    Lane velocity[Count], v_dots[Count];
    for (int i = 0; i < Count; ++i) {
      const Eigen::Index at = (first + i) * m + p;
      const Lane &v0 = lanes<N>(before.velocity + at), &a0 = lanes<N>(before.a + at);
      Lane turned;
      if constexpr (Count == 1) {
        turned = lanes<N>(before.position + at);
      } else {
        turned = T[i] * lanes<N>(before.position + first * m + p);
        for (int j = 1; j < Count; ++j) {
          turned += T[Count * j + i] * lanes<N>(before.position + (first + j) * m + p);
        }
      }
      const Lane a1 = c.a_xi * (turned + c.h * v0) + c.a_a0 * a0;            // eq. (1)
      velocity[i] = v0 + (c.v_a0 * a0 + c.v_a * a1);                         // eq. (2)
      v_dots[i] = c.v_dot_a * (a1 + c.alpha * lanes<N>(before.v_dot + at));  // eq. (2)
      lanes<N>(a + at) = a1;
      lanes<N>(v + at) = velocity[i];
      lanes<N>(v_dot + at) = v_dots[i];
    }
    const int* row = parts.K().innerIndexPtr() + begin;
    const int rows = parts.K().outerIndexPtr()[first + 1] - begin;
    const double *C = parts.C().valuePtr() + begin, *M = parts.M().valuePtr() + begin;
    for (int i = 0; i < rows && row[i] < n_free; ++i) {  // constraints have neither
      Lane sum = C[i] * velocity[0] + M[i] * v_dots[0];
      for (int j = 1; j < Count; ++j) sum += C[j * rows + i] * velocity[j] + M[j * rows + i] * v_dots[j];
      lanes<N>(rhs + row[i] * m + p) -= sum;
    }
  }
};

/// Equation (3) for some parameters.
template <int D>
struct Updating {
  Factors c;
  int n_nodes, n_free;
  const double* right;  // T_r⁻¹ of each node
  const double *solution, *a, *v, *v_dot;
  double *to_position, *to_velocity, *to_v_dot, *to_a;
  Eigen::Index m;

  template <int N>
  [[gnu::always_inline]] void columns(Eigen::Index p) {
    constexpr int n = freedoms<D>;
    for (int k = 0; k < n_nodes; ++k) group<n, N>(n * k, right + n * n * k, p);
    for (int j = n * n_nodes; j < n_free; ++j) group<1, N>(j, nullptr, p);
  }

  template <int Count, int N>
  [[gnu::always_inline]] void group(int first, const double* T, Eigen::Index p) {
    using Lane = typename Lanes<N>::type;
    Lane xi[Count];
    for (int i = 0; i < Count; ++i) xi[i] = lanes<N>(solution + (first + i) * m + p);
    for (int i = 0; i < Count; ++i) {
      const Eigen::Index at = (first + i) * m + p;
      Lane turned = xi[i];
      if constexpr (Count > 1) {
        turned = T[i] * xi[0];
        for (int j = 1; j < Count; ++j) turned += T[Count * j + i] * xi[j];
      }
      lanes<N>(to_position + at) = xi[i];
      lanes<N>(to_a + at) = lanes<N>(a + at) + c.a * turned;
      lanes<N>(to_velocity + at) = lanes<N>(v + at) + c.v * turned;
      lanes<N>(to_v_dot + at) = lanes<N>(v_dot + at) + c.v_dot * turned;
    }
  }
};

/// Equation (4) for some rows of a node's columns.
template <int D>
struct Combining {
  double c_C, c_M;
  const double *K, *C, *M, *right;
  double* S;
  Eigen::Index rows;  // of each of the columns

  template <int N>
  [[gnu::always_inline]] void columns(Eigen::Index i) {
    constexpr int n = freedoms<D>;
    typename Lanes<N>::type inertia[n];
    for (int j = 0; j < n; ++j) {
      const Eigen::Index at = j * rows + i;
      inertia[j] = c_C * lanes<N>(C + at) + c_M * lanes<N>(M + at);
    }
    for (int j = 0; j < n; ++j) {
      typename Lanes<N>::type sum = lanes<N>(K + j * rows + i);
      for (int k = 0; k < n; ++k) sum += right[n * j + k] * inertia[k];
      lanes<N>(S + j * rows + i) = sum;
    }
  }
};

}  // namespace

template <int D>
StepSlopesIn<D>::StepSlopesIn(const assembly::SystemIn<D>& system,
                              const integrators::HhtCoefficients& coefficients)
    : system_(system), coefficients_(coefficients), left_(system.n_nodes()), right_(system.n_nodes()) {}

template <int D>
void StepSlopesIn<D>::prepare(const VectorXd& exponent, double h) {
  h_ = h;
  for (int k = 0; k < system_.n_nodes(); ++k) {
    const Twist<D> h_k = exponent.segment<freedoms<D>>(freedoms<D> * k);
    left_[k] = left_tangent_inverse<D>(h_k);
    right_[k] = right_tangent_inverse<D>(h_k);
  }
}

template <int D>
void StepSlopesIn<D>::carry(const StateDerivative& before, const assembly::TangentPartsIn<D>& parts,
                            Slopes& rhs) {
  const Eigen::Index m = rhs.cols();
  for (Slopes* rows : {&a_, &v_, &v_dot_}) rows->resize(system_.n_free(), m);
  const StepRows rows{before.position.data(), before.velocity.data(), before.v_dot.data(), before.a.data()};
  work_through<columns_at_a_time<D>>(Carrying<D>{{coefficients_, h_},
                                                 parts,
                                                 system_.n_nodes(),
                                                 system_.n_free(),
                                                 left_.data()->data(),
                                                 rows,
                                                 a_.data(),
                                                 v_.data(),
                                                 v_dot_.data(),
                                                 rhs.data(),
                                                 m},
                                     m);
}

template <int D>
void StepSlopesIn<D>::combine(const assembly::TangentPartsIn<D>& parts,
                              Eigen::SparseMatrix<double>& tangent) const {
  const auto [alpha, beta, gamma] = coefficients_;
  const double c_C = gamma / (beta * h_), c_M = 1 / (beta * h_ * h_ * (1 + alpha));
  if (tangent.nonZeros() == 0) tangent = parts.K();
  const double *M = parts.M().valuePtr(), *C = parts.C().valuePtr(), *K = parts.K().valuePtr();
  double* S = tangent.valuePtr();
  parts.visit_columns([&](int first, int count, int begin, int rows) {
    if (count == 1) {
      for (int i = begin; i < begin + rows; ++i) S[i] = K[i] + c_C * C[i] + c_M * M[i];
      return;
    }
    const double* right = right_[first / freedoms<D>].data();
    work_through<4>(Combining<D>{c_C, c_M, K + begin, C + begin, M + begin, right, S + begin, rows}, rows);
  });
}

template <int D>
void StepSlopesIn<D>::update(const Slopes& solution, StateDerivative& now) const {
  work_through<columns_at_a_time<D>>(Updating<D>{{coefficients_, h_},
                                                 system_.n_nodes(),
                                                 system_.n_free(),
                                                 right_.data()->data(),
                                                 solution.data(),
                                                 a_.data(),
                                                 v_.data(),
                                                 v_dot_.data(),
                                                 now.position.data(),
                                                 now.velocity.data(),
                                                 now.v_dot.data(),
                                                 now.a.data(),
                                                 solution.cols()},
                                     solution.cols());
}

template class StepSlopesIn<2>;
template class StepSlopesIn<3>;

}  // namespace flexarm::sensitivity
