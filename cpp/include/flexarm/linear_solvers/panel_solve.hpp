/// @file
/// Triangular solutions with the columns of one supernode for a few right-hand sides at once:
///
///     [y1]   [L11⁻¹           ] [y1]
///     [y2] = [−L21 L11⁻¹   1  ] [y2]                                                                  (1)
///     y1 = L11⁻ᵀ (y1 − L21ᵀ y2)                                                                       (2)
///
/// Entries of L are read once, in order, for all right-hand sides; they come from memory, and a BLAS would
/// first copy them.
#pragma once

#include "flexarm/linear_solvers/dense_kernels.hpp"

namespace flexarm::linear_solvers {

/// Eq. (1). Y holds `width` = 4, 8 or 16 right-hand sides as rows of its `height` columns, one after the
/// other; L has `height` rows and n columns.
void solve_forward(int width, int n, int height, ConstPanel L, double* Y);

/// Eq. (2).
void solve_backward(int width, int n, int height, ConstPanel L, double* Y);

}  // namespace flexarm::linear_solvers
