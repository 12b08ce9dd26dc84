/// @file
/// Neighbouring numbers as vectors of the processor: loops over the columns of matrices that are stored by
/// rows take eight, four, two or one of them at a time.
///
/// A width that is known when compiled keeps a row's numbers in registers from one operation to the next; the
/// run-time length of a row would send them through memory and test for its end every time. Multiplications
/// and additions stay those of IEEE 754, one by one, so the same bits come out whatever vectors the processor
/// knows.
#pragma once

#include <Eigen/Core>

namespace flexarm::simd {

/// N numbers, wherever doubles lie. More than the processor's vectors hold come in two halves: what waits for
/// one lets the other pass.
template <int N>
struct Lanes {
  struct __attribute__((may_alias)) type {
    using Half = typename Lanes<N / 2>::type;
    Half a, b;

    // Copies by halves: the compiler's own go through memory in pieces of two numbers.
    type() = default;
    [[gnu::always_inline]] type(const Half& first, const Half& second) : a(first), b(second) {}
    [[gnu::always_inline]] type(const type& x) : a(x.a), b(x.b) {}
    [[gnu::always_inline]] type& operator=(const type& x) {
      a = x.a;
      b = x.b;
      return *this;
    }
    [[gnu::always_inline]] friend type operator+(const type& x, const type& y) {
      return {x.a + y.a, x.b + y.b};
    }
    [[gnu::always_inline]] friend type operator-(const type& x, const type& y) {
      return {x.a - y.a, x.b - y.b};
    }
    [[gnu::always_inline]] friend type operator*(double factor, const type& x) {
      return {factor * x.a, factor * x.b};
    }
    [[gnu::always_inline]] type& operator+=(const type& x) { return *this = *this + x; }
    [[gnu::always_inline]] type& operator-=(const type& x) { return *this = *this - x; }
  };
};
template <>
struct Lanes<1> {
  typedef double type;
};
template <>
struct Lanes<2> {
  typedef double type __attribute__((vector_size(2 * sizeof(double)), aligned(sizeof(double)), may_alias));
};
template <>
struct Lanes<4> {
  typedef double type __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double)), may_alias));
};
static_assert(alignof(Lanes<8>::type) == alignof(double));

/// N numbers from `first` on.
template <int N>
[[gnu::always_inline]] inline typename Lanes<N>::type& lanes(double* first) {
  return *reinterpret_cast<typename Lanes<N>::type*>(first);
}
template <int N>
[[gnu::always_inline]] inline const typename Lanes<N>::type& lanes(const double* first) {
  return *reinterpret_cast<const typename Lanes<N>::type*>(first);
}

/// As many columns as leave the numbers of a node in registers, in the plane (D = 2) and in space (3).
template <int D>
inline constexpr int columns_at_a_time = D == 2 ? 8 : 4;

/// Calls work.template columns<N>(first) until columns `first` to m have had their turn, `Widest` at a time
/// as long as there are so many, then half of that, and so on.
template <int Widest, class Work>
[[gnu::always_inline]] inline void by_columns(Work& work, Eigen::Index m, Eigen::Index first = 0) {
  for (; first + Widest <= m; first += Widest) work.template columns<Widest>(first);
  if constexpr (Widest > 1) by_columns<Widest / 2>(work, m, first);
}

#if defined(__x86_64__) && defined(__GNUC__)
template <int Widest, class Work>
[[gnu::target("avx2")]] void by_wide_vectors(Work work, Eigen::Index m) {
  by_columns<Widest>(work, m);
}
#endif

/// The same with vectors of four where the processor has them, of two elsewhere. The work's functions are to
/// be inlined, or they are compiled for every processor.
template <int Widest, class Work>
void work_through(Work work, Eigen::Index m) {
#if defined(__x86_64__) && defined(__GNUC__)
  static const bool wide = __builtin_cpu_supports("avx2");
  if (wide) return by_wide_vectors<Widest>(work, m);
#endif
  by_columns<2>(work, m);
}

}  // namespace flexarm::simd
