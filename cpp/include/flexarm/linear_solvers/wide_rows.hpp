/// @file
/// A few columns side by side, 4, 8 or 16 of them: what belongs to one unknown is a row of vectors of four,
/// so that an entry of a matrix is read once for all columns.
#pragma once

#include <cstddef>

namespace flexarm::linear_solvers {

typedef double Four __attribute__((vector_size(4 * sizeof(double))));
typedef Four FourInPlace __attribute__((aligned(sizeof(double)), may_alias));  // wherever doubles lie

/// Width in which so many columns, or the first of them, are held.
inline int width_of(std::ptrdiff_t columns) { return columns > 8 ? 16 : columns > 4 ? 8 : 4; }

/// Row k of Y in V vectors.
template <int V>
[[gnu::always_inline]] inline FourInPlace* row(double* Y, std::ptrdiff_t k) {
  return reinterpret_cast<FourInPlace*>(Y + 4 * V * k);
}
template <int V>
[[gnu::always_inline]] inline const FourInPlace* row(const double* Y, std::ptrdiff_t k) {
  return reinterpret_cast<const FourInPlace*>(Y + 4 * V * k);
}

template <class Work, class... Arguments>
[[gnu::always_inline]] inline void by_width(int width, const Arguments&... arguments) {
  if (width == 16) return Work::template run<4>(arguments...);
  if (width == 8) return Work::template run<2>(arguments...);
  Work::template run<1>(arguments...);
}

#if defined(__x86_64__) && defined(__GNUC__)
template <class Work, class... Arguments>
[[gnu::target("avx2,fma")]] void by_wide_vectors(int width, const Arguments&... arguments) {
  by_width<Work>(width, arguments...);
}
#endif

/// Work::run<V> with V vectors a row, with vectors of four where the processor has them, of two elsewhere. It
/// is to be inlined, or it is compiled for every processor.
template <class Work, class... Arguments>
void in_wide_rows(int width, const Arguments&... arguments) {
#if defined(__x86_64__) && defined(__GNUC__)
  static const bool wide = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (wide) return by_wide_vectors<Work>(width, arguments...);
#endif
  by_width<Work>(width, arguments...);
}

}  // namespace flexarm::linear_solvers
