#include "flexarm/solids/cell.hpp"

#include <sstream>

#include "flexarm/errors.hpp"
#include "flexarm/solids/cell_matrices.hpp"

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

void refuse_shape(const SolidMesh& mesh, std::size_t block, Eigen::Index cell, double scaled_jacobian) {
  std::ostringstream message;
  message << cell_name(mesh, block, cell)
          << " is inverted or flat: its scaled Jacobian must be positive, got " << scaled_jacobian;
  throw InvalidParameter(message.str());
}

}  // namespace flexarm::solids
