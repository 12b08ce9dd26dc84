#include "flexarm/solids/cell.hpp"

namespace flexarm::solids {

std::vector<Eigen::VectorXd> smallest_jacobians(const SolidMesh& mesh) {
  std::vector<Eigen::VectorXd> smallest;
  for (const CellBlock& block : mesh.blocks()) {
    Eigen::VectorXd& values = smallest.emplace_back(block.n_cells());
    with_cell(block.type, [&]<class Cell>(Cell) {
      for (Eigen::Index c = 0; c < block.n_cells(); ++c)
        values[c] = smallest_jacobian<Cell>(node_positions<Cell>(mesh.points(), block.nodes.row(c).data()));
    });
  }
  return smallest;
}

}  // namespace flexarm::solids
