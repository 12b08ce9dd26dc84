#include "flexarm/solids/mass_properties.hpp"

#include "flexarm/solids/cell_matrices.hpp"

namespace flexarm::solids {
namespace {

/// Adds one cell: its mass, first moment and ∫ ρ x xᵀ dV.
template <class Cell>
void add_cell(const NodePositions<Cell>& X, const Eigen::Vector3d& x0, double density, MassProperties& sum) {
  const auto& table = mass_table<Cell>();
  const double smallest = smallest_determinant<Cell>(X);
  for (Eigen::Index p = 0; p < table.values.cols(); ++p) {
    const double det = jacobian<Cell>(X, table.gradients[p]).determinant();
    if (!(det > smallest)) throw BadShape{};
    const double m = density * table.rule.weights[p] * det;
    const Eigen::Vector3d x = x0 + X * table.values.col(p);
    sum.mass += m;
    sum.first_moment += m * x;
    sum.inertia += m * x * x.transpose();
  }
}

}  // namespace

MassProperties mass_properties(const SolidMesh& mesh) {
  MassProperties sum;
  for (std::size_t block = 0; block < mesh.blocks().size(); ++block) {
    const CellBlock& cells = mesh.blocks()[block];
    with_cell(cells.type, [&]<class Cell>(Cell) {
      for (Eigen::Index c = 0; c < cells.n_cells(); ++c) {
        const Eigen::Vector3d x0 = mesh.points().row(cells.nodes(c, 0)).transpose();
        with_positions<Cell>(mesh, block, c,
                             [&](const NodePositions<Cell>& X, const SolidMaterial& material) {
                               add_cell<Cell>(X, x0, material.density, sum);
                             });
      }
    });
  }
  sum.inertia = sum.inertia.trace() * Eigen::Matrix3d::Identity() - sum.inertia.eval();  // eq. (1)
  return sum;
}

}  // namespace flexarm::solids
