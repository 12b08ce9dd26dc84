/// @file
/// Symbolic Cholesky factorisation P A Pᵀ = L Lᵀ in supernodes: runs of columns of L that share their rows
/// below the run, so that dense kernels do the work. Neighbouring unknowns with the same neighbours, as the
/// three displacements of a point, are ordered as one. Sources: [Liu1990] for the elimination tree,
/// [Duff1983] for supernodes that take few zeros along.
#pragma once

#include <cstddef>
#include <vector>

#include "flexarm/linear_solvers/fill_ordering.hpp"

namespace flexarm::linear_solvers {

/// Supernode s holds the columns first[s] to first[s+1] − 1 in the order of elimination.
struct Supernodes {
  std::vector<int> order;  ///< order[k]: the column of A eliminated as k-th
  std::vector<int> first;
  std::vector<int> parent;                ///< the supernode of the first row below; −1 where there is none
  std::vector<std::ptrdiff_t> row_start;  ///< into `rows`
  std::vector<int> rows;                  ///< below the columns of s, rising
  FillOrdering found;                     ///< entries in unknowns
  double entries = 0, operations = 0;     ///< of L without the zeros taken along

  int count() const { return static_cast<int>(parent.size()); }
  int n_columns(int s) const { return first[s + 1] - first[s]; }
  int n_rows(int s) const { return static_cast<int>(row_start[s + 1] - row_start[s]); }
};

Supernodes supernodes(const LowerTriangle& A);

}  // namespace flexarm::linear_solvers
