/// @file
/// Products and triangular solutions of dense column-major matrices by the BLAS that is loaded, in double or
/// single precision; by Eigen where there is none.
#pragma once

#include <cstddef>

namespace flexarm::solvers {

/// A matrix in memory: its first entry and the distance of its columns.
template <class Scalar>
struct Panel {
  Scalar* data;
  std::ptrdiff_t stride;

  Panel at(std::ptrdiff_t row, std::ptrdiff_t column) const { return {data + row + column * stride, stride}; }
  Scalar& operator()(std::ptrdiff_t row, std::ptrdiff_t column) const { return data[row + column * stride]; }
};

enum class Transposed { no, yes };

/// C := C + factor op(A) op(B), C of m rows and n columns, k between A and B.
template <class Scalar>
void add_product(Transposed a, Transposed b, int m, int n, int k, Scalar factor, Panel<const Scalar> A,
                 Panel<const Scalar> B, Panel<Scalar> C);

/// C := C − A Aᵀ, its lower triangle, A of n rows and k columns.
template <class Scalar>
void subtract_square(int n, int k, Panel<const Scalar> A, Panel<Scalar> C);

/// X := X op(L)⁻¹, X of m rows, L a lower triangle of n.
template <class Scalar>
void solve_right(Transposed l, int m, int n, Panel<const Scalar> L, Panel<Scalar> X);

}  // namespace flexarm::solvers
