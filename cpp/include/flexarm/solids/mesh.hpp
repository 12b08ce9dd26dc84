/// @file
/// A solid part as data: points, blocks of cells of one type, materials.
///
/// Nodes of a cell are numbered as in VTK: hexahedra with corners 0-3 around the bottom and 4-7 above them,
/// then the middles of edges 01 12 23 30, 45 56 67 74, 04 15 26 37; tetrahedra with corners 0-3, then 01 12
/// 02 03 13 23. The displacement of a point has the freedoms 3 point + axis. Units: SI.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace flexarm::solids {

enum class CellType { tet4, tet10, hex8, hex20 };

std::string name(CellType type);
int nodes_per_cell(CellType type);

/// Isotropic, linear elastic.
struct SolidMaterial {
  double youngs_modulus;  // [Pa], positive
  double poisson_ratio;   // in (−1, ½)
  double density;         // [kg/m³], not negative
};

using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using CellNodes = Eigen::Matrix<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Cells of one type: a row of points and the index of a material each, all counted from zero.
struct CellBlock {
  CellType type;
  CellNodes nodes;
  Eigen::VectorXi material;

  Eigen::Index n_cells() const { return nodes.rows(); }
};

class SolidMesh {
 public:
  /// @throws InvalidParameter if an index points to nothing or a value is not allowed; it names block and
  /// cell.
  SolidMesh(Points points, std::vector<CellBlock> blocks, std::vector<SolidMaterial> materials);

  const Points& points() const { return points_; }
  const std::vector<CellBlock>& blocks() const { return blocks_; }
  const std::vector<SolidMaterial>& materials() const { return materials_; }
  Eigen::Index n_points() const { return points_.rows(); }
  Eigen::Index n_dof() const { return 3 * n_points(); }

 private:
  Points points_;
  std::vector<CellBlock> blocks_;
  std::vector<SolidMaterial> materials_;
};

/// "block 1 (hex8), cell 17", as messages name a cell.
std::string cell_name(const SolidMesh& mesh, std::size_t block, Eigen::Index cell);

}  // namespace flexarm::solids
