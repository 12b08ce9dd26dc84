/// @file
/// Stiffness and mass of a whole part in compressed columns,
///
///     K = Σ_e A_eᵀ K_e A_e,   M = Σ_e A_eᵀ (m_e ⊗ I₃) A_e                                               (1)
///
/// with A_e the selection of a cell's freedoms. The pattern follows from the graph of points. Threads first
/// compute the matrices of a batch of cells, then add them, each thread to columns of its own and in the
/// order of the cells: every entry is the same sum in the same order, so results are equal to the last bit
/// for any number of threads.
#pragma once

#include <Eigen/SparseCore>

#include "flexarm/solids/mesh.hpp"

namespace flexarm::solids {

using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

/// Lower triangles; freedom 3 point + axis; columns of points that no cell uses are empty.
struct SolidMatrices {
  SparseMatrix K;  // [N/m]
  SparseMatrix M;  // [kg]
};

/// @param lumped diagonal mass instead of the consistent one. @param n_threads 0: one a core.
/// @throws InvalidParameter that names the cell if one is inverted or flat.
SolidMatrices assemble(const SolidMesh& mesh, bool lumped, int n_threads);

}  // namespace flexarm::solids
