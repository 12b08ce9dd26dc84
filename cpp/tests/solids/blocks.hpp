/// @file
/// Meshes of mapped boxes, of any type of cell, and static solutions on them.
#pragma once

#include <functional>
#include <vector>

#include "flexarm/solids/assemble.hpp"
#include "flexarm/solids/cell.hpp"
#include "numerics.hpp"

namespace flexarm::tests {

using namespace flexarm::solids;
using Eigen::Matrix3d;
using Eigen::Vector3d;

inline const SolidMaterial block_steel{210e9, 0.3, 7850};
inline const std::vector<CellType> all_types{CellType::tet4, CellType::tet10, CellType::hex8,
                                             CellType::hex20};

using Map = std::function<Vector3d(const Vector3d&)>;

inline bool is_tetrahedron(CellType type) { return type == CellType::tet4 || type == CellType::tet10; }
inline bool is_quadratic(CellType type) { return type == CellType::tet10 || type == CellType::hex20; }

/// The unit cube in n[0] × n[1] × n[2] boxes, mapped; tetrahedra fill each box by six.
SolidMesh mapped_box(CellType type, const Eigen::Vector3i& n, const Map& map,
                     const SolidMaterial& material = block_steel);

Map scaled_to(const Vector3d& size);

/// The same cells with other points, or with other materials.
SolidMesh with_points(const SolidMesh& mesh, const Points& points);
SolidMesh with_material(const SolidMesh& mesh, const SolidMaterial& material);

/// Every point moved at random by up to `size`; straight edges become curved.
SolidMesh distorted(const SolidMesh& mesh, double size, unsigned seed);

MatrixXd dense(const SparseMatrix& lower);

VectorXd times(const SparseMatrix& lower, const VectorXd& x);

/// Freedoms of a field of displacements.
VectorXd at_points(const SolidMesh& mesh, const Map& field);

/// Rigid motions: three translations and three rotations about the origin.
MatrixXd rigid_motions(const SolidMesh& mesh);

/// Freedoms (point, axis) for which chosen(x, axis) holds.
std::vector<bool> freedoms(const SolidMesh& mesh, const std::function<bool(const Vector3d&, int)>& chosen);

/// The freedoms that are not in `held`, in lower triangles.
SparseMatrix free_part(const SparseMatrix& lower, const std::vector<bool>& held);

VectorXd free_part(const VectorXd& x, const std::vector<bool>& held);

/// Displacements under `load`, with those of `held` as in `prescribed`.
VectorXd solve(const SparseMatrix& K, const VectorXd& load, const std::vector<bool>& held,
               VectorXd prescribed);

}  // namespace flexarm::tests
