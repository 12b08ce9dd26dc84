/// @file
/// N real numbers side by side in one vector register, one for each of N arms that step together.
///
/// Formulas that are written for any kind of numbers serve one arm with double and N of them with Pack, lane
/// by lane the same operations of IEEE 754. No lane depends on what stands in the others.
#pragma once

#include <Eigen/Core>
#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace flexarm::simd {

/// N numbers as the compiler's vector.
template <int N>
struct VectorOf;
template <>
struct VectorOf<2> {
  typedef double type __attribute__((vector_size(2 * sizeof(double)), may_alias));
};
template <>
struct VectorOf<4> {
  typedef double type __attribute__((vector_size(4 * sizeof(double)), may_alias));
};
template <>
struct VectorOf<8> {
  typedef double type __attribute__((vector_size(8 * sizeof(double)), may_alias));
};

/// @param Processor names the processor that the code is compiled for, so that it is not taken for the same
/// code of another one.
template <int N, class Processor>
class Pack {
 public:
  static constexpr int lanes = N;

  Pack() = default;
  [[gnu::always_inline]] Pack(double all) : lanes_(Lanes{} + all) {}

  /// N numbers from a place that is a multiple of N numbers away from the beginning of a block.
  [[gnu::always_inline]] static Pack at(const double* numbers) {
    return Pack(*reinterpret_cast<const Lanes*>(numbers));
  }
  [[gnu::always_inline]] void put(double* numbers) const { *reinterpret_cast<Lanes*>(numbers) = lanes_; }

  [[gnu::always_inline]] double operator[](int lane) const { return lanes_[lane]; }
  [[gnu::always_inline]] void set(int lane, double value) { lanes_[lane] = value; }

  [[gnu::always_inline]] friend Pack operator+(const Pack& a, const Pack& b) {
    return Pack(a.lanes_ + b.lanes_);
  }
  [[gnu::always_inline]] friend Pack operator-(const Pack& a, const Pack& b) {
    return Pack(a.lanes_ - b.lanes_);
  }
  [[gnu::always_inline]] friend Pack operator*(const Pack& a, const Pack& b) {
    return Pack(a.lanes_ * b.lanes_);
  }
  [[gnu::always_inline]] friend Pack operator/(const Pack& a, const Pack& b) {
    return Pack(a.lanes_ / b.lanes_);
  }
  [[gnu::always_inline]] Pack operator-() const { return Pack(-lanes_); }
  [[gnu::always_inline]] Pack& operator+=(const Pack& other) { return *this = *this + other; }
  [[gnu::always_inline]] Pack& operator-=(const Pack& other) { return *this = *this - other; }
  [[gnu::always_inline]] Pack& operator*=(const Pack& other) { return *this = *this * other; }

  [[gnu::always_inline]] static Pack larger(const Pack& a, const Pack& b) {
    return Pack(a.lanes_ > b.lanes_ ? a.lanes_ : b.lanes_);
  }
  [[gnu::always_inline]] Pack magnitude() const { return Pack(lanes_ < 0 ? -lanes_ : lanes_); }
  /// These numbers where `chosen` is not zero, zero elsewhere.
  [[gnu::always_inline]] Pack where(const Pack& chosen) const {
    return Pack(chosen.lanes_ != 0 ? lanes_ : Lanes{});
  }
  /// 1 where a number is below the limit, 0 elsewhere.
  [[gnu::always_inline]] Pack ones_below(double limit) const {
    return Pack(lanes_ < limit ? Lanes{} + 1.0 : Lanes{});
  }
  [[gnu::always_inline]] Pack root() const {
#ifdef __AVX512F__
    if constexpr (N == 8) return Pack(Lanes(_mm512_sqrt_pd(lanes_)));
#endif
#ifdef __AVX2__
    if constexpr (N == 4) return Pack(Lanes(_mm256_sqrt_pd(lanes_)));
#endif
    Pack roots;
    for (int k = 0; k < N; ++k) roots.set(k, __builtin_sqrt(lanes_[k]));
    return roots;
  }
  [[gnu::always_inline]] bool all_below(double limit) const {
#ifdef __AVX512F__
    if constexpr (N == 8) return _mm512_cmp_pd_mask(lanes_, _mm512_set1_pd(limit), _CMP_LT_OQ) == 0xff;
#endif
#ifdef __AVX2__
    if constexpr (N == 4) return _mm256_movemask_pd(lanes_ < limit) == 0xf;
#endif
    bool below = true;
    for (int k = 0; k < N; ++k) below &= lanes_[k] < limit;
    return below;
  }

 private:
  using Lanes = typename VectorOf<N>::type;
  [[gnu::always_inline]] explicit Pack(const Lanes& numbers) : lanes_(numbers) {}
  Lanes lanes_;
};

}  // namespace flexarm::simd

template <int N, class Processor>
struct Eigen::NumTraits<flexarm::simd::Pack<N, Processor>> {
  using Real = flexarm::simd::Pack<N, Processor>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = double;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};

template <int N, class Processor, class Operation>
struct Eigen::ScalarBinaryOpTraits<double, flexarm::simd::Pack<N, Processor>, Operation> {
  using ReturnType = flexarm::simd::Pack<N, Processor>;
};
