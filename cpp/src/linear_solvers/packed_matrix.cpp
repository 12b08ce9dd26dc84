#include "flexarm/linear_solvers/packed_matrix.hpp"

#include <algorithm>

// Compiled once for every x86-64 and once with vectors of four; the loader chooses. Sanitizers come too late
// for its choice.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define FLEXARM_FOR_EVERY_PROCESSOR __attribute__((target_clones("avx2", "default")))
#else
#define FLEXARM_FOR_EVERY_PROCESSOR
#endif

namespace flexarm::linear_solvers {
namespace {

using Eigen::Index;

typedef double Four __attribute__((vector_size(4 * sizeof(double))));
typedef Four FourInPlace __attribute__((aligned(sizeof(double)), may_alias));  // wherever doubles lie

/// Equation (1) for `Blocks` times four rows.
template <int Blocks>
[[gnu::always_inline]] inline void multiply_rows(const double* column, Index stride, Index n_columns,
                                                 const double* x, double* y) {
  Four sum[Blocks];
  for (int k = 0; k < Blocks; ++k) sum[k] = Four{0, 0, 0, 0};
  for (Index j = 0; j < n_columns; ++j, column += stride) {
    for (int k = 0; k < Blocks; ++k) {
      sum[k] += *reinterpret_cast<const FourInPlace*>(column + 4 * k) * x[j];
    }
  }
  for (int k = 0; k < Blocks; ++k) *reinterpret_cast<FourInPlace*>(y + 4 * k) = sum[k];
}

FLEXARM_FOR_EVERY_PROCESSOR
void multiply_packed(const double* columns, Index n_rows, Index n_columns, const double* x, double* y) {
  constexpr Index at_once = 6 * PackedMatrix::lanes;  // sums that fit into registers
  Index row = 0;
  for (; row + at_once <= n_rows; row += at_once) {
    multiply_rows<6>(columns + row, n_rows, n_columns, x, y + row);
  }
  switch ((n_rows - row) / PackedMatrix::lanes) {
    case 5:
      return multiply_rows<5>(columns + row, n_rows, n_columns, x, y + row);
    case 4:
      return multiply_rows<4>(columns + row, n_rows, n_columns, x, y + row);
    case 3:
      return multiply_rows<3>(columns + row, n_rows, n_columns, x, y + row);
    case 2:
      return multiply_rows<2>(columns + row, n_rows, n_columns, x, y + row);
    case 1:
      return multiply_rows<1>(columns + row, n_rows, n_columns, x, y + row);
    default:
      return;
  }
}

}  // namespace

PackedMatrix::PackedMatrix(const Eigen::MatrixXd& A)
    : rows_(A.rows()),
      cols_(A.cols()),
      filled_rows_((A.rows() + lanes - 1) / lanes * lanes),
      columns_(static_cast<std::size_t>(filled_rows_ * A.cols()), 0.0) {
  for (Index j = 0; j < cols_; ++j) {
    std::copy_n(A.data() + j * rows_, rows_, columns_.data() + j * filled_rows_);
  }
}

void PackedMatrix::multiply(const double* x, double* y) const {
  multiply_packed(columns_.data(), filled_rows_, cols_, x, y);
}

}  // namespace flexarm::linear_solvers
