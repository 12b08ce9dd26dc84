/// @file
/// Products and triangular solutions of dense column-major matrices by the BLAS that is loaded; by Eigen
/// where there is none.
#pragma once

#include <cstddef>

namespace flexarm::linear_solvers {

/// A matrix in memory: its first entry and the distance of its columns.
template <class Entry>
struct MatrixView {
  Entry* data;
  std::ptrdiff_t stride;

  MatrixView at(std::ptrdiff_t row, std::ptrdiff_t column) const {
    return {data + row + column * stride, stride};
  }
  Entry& operator()(std::ptrdiff_t row, std::ptrdiff_t column) const { return data[row + column * stride]; }
  operator MatrixView<const Entry>() const { return {data, stride}; }
};
using Panel = MatrixView<double>;
using ConstPanel = MatrixView<const double>;

enum class Transposed { no, yes };

/// C := C + factor op(A) op(B), C of m rows and n columns, k between A and B.
void add_product(Transposed a, Transposed b, int m, int n, int k, double factor, ConstPanel A, ConstPanel B,
                 Panel C);

/// C := C − A Aᵀ, its lower triangle, A of n rows and k columns.
void subtract_square(int n, int k, ConstPanel A, Panel C);

/// X := X L⁻ᵀ, X of m rows, L a lower triangle of n.
void solve_right(int m, int n, ConstPanel L, Panel X);

}  // namespace flexarm::linear_solvers
