/// @file
/// Rows of N numbers, one a lane, where vector registers can take them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>

#include "flexarm/lanes/numbers.hpp"

namespace flexarm::lanes {

class Rows {
 public:
  Rows() = default;
  Rows(int rows, int lanes) : lanes_(lanes), size_(static_cast<std::size_t>(rows) * lanes) {
    numbers_.reset(
        static_cast<double*>(::operator new(std::max<std::size_t>(size_, 1) * sizeof(double), line)));
    std::fill_n(numbers_.get(), size_, 0.0);
  }

  double& operator()(int row, int lane) {
    return numbers_.get()[static_cast<std::size_t>(row) * lanes_ + lane];
  }
  double operator()(int row, int lane) const {
    return numbers_.get()[static_cast<std::size_t>(row) * lanes_ + lane];
  }
  double* data() { return numbers_.get(); }
  const double* data() const { return numbers_.get(); }

  /// Writes the numbers of a matrix by columns into a lane, from a row on. @return the row behind them
  template <class Matrix>
  int put(int row, int lane, const Matrix& m) {
    for (int j = 0; j < m.cols(); ++j) {
      for (int i = 0; i < m.rows(); ++i) (*this)(row++, lane) = m(i, j);
    }
    return row;
  }
  /// The same by blocks of rows (lanes/numbers.hpp), of rows `first` to `first + count` and some columns.
  template <class Matrix>
  int put_blocks(int row, int lane, const Matrix& m, int first, int count, int columns) {
    for (int at = first; at < first + count; at += block_rows) {
      const int behind = std::min(at + block_rows, first + count);
      for (int j = 0; j < columns; ++j) {
        for (int i = at; i < behind; ++i) (*this)(row++, lane) = m(i, j);
      }
    }
    return row;
  }
  /// The numbers of a vector, from a row on.
  template <class Vector>
  void take(int row, int lane, Vector&& v) const {
    for (int i = 0; i < v.size(); ++i) v[i] = (*this)(row + i, lane);
  }

 private:
  static constexpr std::align_val_t line{64};  // of a cache, and the widest vector
  struct Free {
    void operator()(double* numbers) const { ::operator delete(numbers, line); }
  };
  int lanes_ = 0;
  std::size_t size_ = 0;
  std::unique_ptr<double, Free> numbers_;
};

}  // namespace flexarm::lanes
