/// @file
/// Stresses of a part from its displacements.
///
/// In each cell, at the points where strains are most accurate (2 × 2 × 2 in hexahedra [Barlow1976], four in
/// tetrahedra),
///
///     ε = ½ Σ_a (g_a u_aᵀ + u_a g_aᵀ),   σ = λ tr(ε) I + 2 μ ε                                           (1)
///
/// the incompatible modes of hex8 included, with coordinates from the nodes' displacements
/// (cell_matrices.hpp, eq. (4)). A (tri)linear function through these points gives the stress at the cell's
/// nodes; a point has the mean over its cells, weighted by their volumes [HintonCampbell1974]. On the surface
/// between two materials that mean hides the jump.
#pragma once

#include <Eigen/Core>

#include "flexarm/solids/mesh.hpp"

namespace flexarm::solids {

/// σ_xx, σ_yy, σ_zz, σ_xy, σ_yz, σ_zx of each point [Pa].
using Stresses = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>;

/// @param displacements of the points [m]; zero stress at points of no cell.
/// @throws InvalidParameter if there are not as many displacements as points, or a cell is inverted or flat.
Stresses stresses(const SolidMesh& mesh, const Points& displacements);

/// √(½ ((σ_x − σ_y)² + (σ_y − σ_z)² + (σ_z − σ_x)²) + 3 (τ_xy² + τ_yz² + τ_zx²)) of the points' stresses.
Eigen::VectorXd von_mises(const Stresses& stresses);

}  // namespace flexarm::solids
