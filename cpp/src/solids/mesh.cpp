#include "flexarm/solids/mesh.hpp"

#include <cmath>
#include <sstream>

#include "flexarm/errors.hpp"

namespace flexarm::solids {
namespace {

template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  std::ostringstream message;
  (message << ... << parts);
  throw InvalidParameter(message.str());
}

/// "block 1 (hex8), cell 17".
std::string cell_name(std::size_t block, CellType type, Eigen::Index cell) {
  return "block " + std::to_string(block) + " (" + name(type) + "), cell " + std::to_string(cell);
}

void check(const SolidMaterial& m, std::size_t index) {
  const auto where = "material " + std::to_string(index) + ": ";
  if (!(m.youngs_modulus > 0 && std::isfinite(m.youngs_modulus)))
    refuse(where, "Young's modulus must be positive, got ", m.youngs_modulus, " Pa");
  if (!(m.poisson_ratio > -1 && m.poisson_ratio < 0.5))
    refuse(where, "Poisson's ratio must lie between -1 and 0.5, got ", m.poisson_ratio);
  if (!(m.density >= 0 && std::isfinite(m.density)))
    refuse(where, "density must not be negative, got ", m.density, " kg/m3");
}

void check(const Points& points) {
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    if (!points.row(i).allFinite()) refuse("point ", i, ": coordinates must be finite, got ", points.row(i));
}

void check(const CellBlock& block, std::size_t index, Eigen::Index n_points, std::size_t n_materials) {
  const int n_nodes = nodes_per_cell(block.type);
  const std::string where = "block " + std::to_string(index) + " (" + name(block.type) + "): ";
  if (block.nodes.cols() != n_nodes && block.n_cells() > 0)
    refuse(where, "a cell has ", n_nodes, " nodes, got ", block.nodes.cols());
  if (block.material.size() != block.n_cells())
    refuse(where, "needs one material for each of ", block.n_cells(), " cells, got ", block.material.size());
  for (Eigen::Index c = 0; c < block.n_cells(); ++c) {
    for (const int node : block.nodes.row(c))
      if (node < 0 || node >= n_points)
        refuse(cell_name(index, block.type, c), ": node ", node, " is none of the ", n_points,
               " points, counted from 0");
    if (block.material[c] < 0 || static_cast<std::size_t>(block.material[c]) >= n_materials)
      refuse(cell_name(index, block.type, c), ": material ", block.material[c], " is none of the ",
             n_materials, " materials, counted from 0");
  }
}

}  // namespace

std::string name(CellType type) {
  static const char* const names[] = {"tet4", "tet10", "hex8", "hex20"};
  return names[static_cast<int>(type)];
}

int nodes_per_cell(CellType type) {
  static constexpr int counts[] = {4, 10, 8, 20};
  return counts[static_cast<int>(type)];
}

SolidMesh::SolidMesh(Points points, std::vector<CellBlock> blocks, std::vector<SolidMaterial> materials)
    : points_(std::move(points)), blocks_(std::move(blocks)), materials_(std::move(materials)) {
  check(points_);
  for (std::size_t i = 0; i < materials_.size(); ++i) check(materials_[i], i);
  Eigen::Index n_cells = 0;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    check(blocks_[i], i, n_points(), materials_.size());
    n_cells += blocks_[i].n_cells();
  }
  if (n_cells == 0) refuse("a solid mesh needs at least one cell");
}

std::string cell_name(const SolidMesh& mesh, std::size_t block, Eigen::Index cell) {
  return cell_name(block, mesh.blocks()[block].type, cell);
}

}  // namespace flexarm::solids
