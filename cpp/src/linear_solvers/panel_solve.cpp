#include "flexarm/linear_solvers/panel_solve.hpp"

#include "flexarm/linear_solvers/wide_rows.hpp"

namespace flexarm::linear_solvers {
namespace {

using Index = std::ptrdiff_t;

// Columns of L that are read together.
constexpr int together = 4;

/// Y_i −= Σ_j L_ij Y_j over K columns j from `first`, for the rows i from `begin` up to `end`.
template <int V, int K>
[[gnu::always_inline]] inline void subtract_columns(ConstPanel L, double* Y, Index first, Index begin,
                                                    Index end) {
  Four y[K][V];
  for (int k = 0; k < K; ++k)
    for (int v = 0; v < V; ++v) y[k][v] = row<V>(Y, first + k)[v];
  const double* column = L.data + first * L.stride;
  for (Index i = begin; i < end; ++i) {
    FourInPlace* target = row<V>(Y, i);
    for (int k = 0; k < K; ++k) {
      const double entry = column[i + k * L.stride];
      for (int v = 0; v < V; ++v) target[v] -= entry * y[k][v];
    }
  }
}

/// Y_j −= Σ_i L_ij Y_i for K columns j from `first`, over the rows i from `begin` up to `end`.
template <int V, int K>
[[gnu::always_inline]] inline void subtract_rows(ConstPanel L, double* Y, Index first, Index begin,
                                                 Index end) {
  Four sum[K][V];
  for (int k = 0; k < K; ++k)
    for (int v = 0; v < V; ++v) sum[k][v] = row<V>(Y, first + k)[v];
  const double* column = L.data + first * L.stride;
  for (Index i = begin; i < end; ++i) {
    const FourInPlace* source = row<V>(Y, i);
    for (int k = 0; k < K; ++k) {
      const double entry = column[i + k * L.stride];
      for (int v = 0; v < V; ++v) sum[k][v] -= entry * source[v];
    }
  }
  for (int k = 0; k < K; ++k)
    for (int v = 0; v < V; ++v) row<V>(Y, first + k)[v] = sum[k][v];
}

template <int V>
[[gnu::always_inline]] inline void divide(ConstPanel L, double* Y, Index k) {
  for (int v = 0; v < V; ++v) row<V>(Y, k)[v] /= L(k, k);
}

struct Forward {
  template <int V>
  [[gnu::always_inline]] static inline void run(Index n, Index height, ConstPanel L, double* Y) {
    Index j = 0;
    for (; j + together <= n; j += together) {
      for (Index k = j; k < j + together; ++k) {
        divide<V>(L, Y, k);
        subtract_columns<V, 1>(L, Y, k, k + 1, j + together);
      }
      subtract_columns<V, together>(L, Y, j, j + together, height);
    }
    for (; j < n; ++j) {
      divide<V>(L, Y, j);
      subtract_columns<V, 1>(L, Y, j, j + 1, height);
    }
  }
};

struct Backward {
  template <int V>
  [[gnu::always_inline]] static inline void run(Index n, Index height, ConstPanel L, double* Y) {
    Index j = n;
    for (; j % together != 0; --j) {
      subtract_rows<V, 1>(L, Y, j - 1, j, height);
      divide<V>(L, Y, j - 1);
    }
    for (; j > 0; j -= together) {
      const Index first = j - together;
      subtract_rows<V, together>(L, Y, first, j, height);
      for (Index k = j - 1; k >= first; --k) {
        subtract_rows<V, 1>(L, Y, k, k + 1, j);
        divide<V>(L, Y, k);
      }
    }
  }
};

}  // namespace

void solve_forward(int width, int n, int height, ConstPanel L, double* Y) {
  in_wide_rows<Forward>(width, n, height, L, Y);
}

void solve_backward(int width, int n, int height, ConstPanel L, double* Y) {
  in_wide_rows<Backward>(width, n, height, L, Y);
}

}  // namespace flexarm::linear_solvers
