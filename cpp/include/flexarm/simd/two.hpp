/// @file
/// Two real numbers side by side in one vector register: what is computed for them takes the time of one.
///
/// An element or a node takes a chain of operations of which each waits for the one before. Formulas that are
/// written for any kind of numbers serve one element with double and two of them with Two, lane by lane the
/// same operations of IEEE 754.
#pragma once

#include <Eigen/Core>

namespace flexarm::simd {

class Two {
 public:
  Two() = default;
  Two(double both) : lanes_{both, both} {}
  Two(double first, double second) : lanes_{first, second} {}

  double operator[](int lane) const { return lanes_[lane]; }

  friend Two operator+(Two a, Two b) { return Two(a.lanes_ + b.lanes_); }
  friend Two operator-(Two a, Two b) { return Two(a.lanes_ - b.lanes_); }
  friend Two operator*(Two a, Two b) { return Two(a.lanes_ * b.lanes_); }
  friend Two operator/(Two a, Two b) { return Two(a.lanes_ / b.lanes_); }
  Two operator-() const { return Two(-lanes_); }
  Two& operator+=(Two other) { return *this = *this + other; }
  Two& operator-=(Two other) { return *this = *this - other; }
  Two& operator*=(Two other) { return *this = *this * other; }

  bool both_below(double limit) const { return lanes_[0] < limit && lanes_[1] < limit; }
  bool both_above(double limit) const { return lanes_[0] > limit && lanes_[1] > limit; }

 private:
  typedef double Lanes __attribute__((vector_size(2 * sizeof(double))));
  explicit Two(Lanes lanes) : lanes_(lanes) {}
  Lanes lanes_;
};

/// Two matrices as one of twos, and back.
template <int Rows, int Columns>
Eigen::Matrix<Two, Rows, Columns> side_by_side(const Eigen::Matrix<double, Rows, Columns>& first,
                                               const Eigen::Matrix<double, Rows, Columns>& second) {
  Eigen::Matrix<Two, Rows, Columns> both;
  for (int k = 0; k < Rows * Columns; ++k) both.data()[k] = Two(first.data()[k], second.data()[k]);
  return both;
}
template <int Rows, int Columns>
Eigen::Matrix<double, Rows, Columns> lane(const Eigen::Matrix<Two, Rows, Columns>& both, int which) {
  Eigen::Matrix<double, Rows, Columns> one;
  for (int k = 0; k < Rows * Columns; ++k) one.data()[k] = both.data()[k][which];
  return one;
}

}  // namespace flexarm::simd

template <>
struct Eigen::NumTraits<flexarm::simd::Two> {
  using Real = flexarm::simd::Two;
  using NonInteger = flexarm::simd::Two;
  using Nested = flexarm::simd::Two;
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

template <class Operation>
struct Eigen::ScalarBinaryOpTraits<double, flexarm::simd::Two, Operation> {
  using ReturnType = flexarm::simd::Two;
};
