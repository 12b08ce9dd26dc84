/// @file
/// What all cells share: their types, one after the other, and the shape functions at their integration
/// points.
#pragma once

#include <algorithm>
#include <type_traits>
#include <utility>
#include <vector>

#include "flexarm/solids/hexahedron.hpp"
#include "flexarm/solids/tetrahedron.hpp"

namespace flexarm::solids {

/// Calls work(Cell{}) with the cell of that type: Tet4, Tet10, Hex8 or Hex20.
template <class Work>
decltype(auto) with_cell(CellType type, Work&& work) {
  switch (type) {
    case CellType::tet4:
      return work(Tet4{});
    case CellType::tet10:
      return work(Tet10{});
    case CellType::hex8:
      return work(Hex8{});
    default:
      return work(Hex20{});
  }
}

/// Coordinates of a cell's nodes, one column each.
template <class Cell>
using NodePositions = Eigen::Matrix<double, 3, Cell::n_nodes>;

/// Relative to its first node, so that a part far from the origin loses no digits.
template <class Cell>
NodePositions<Cell> node_positions(const Points& points, const int* nodes) {
  NodePositions<Cell> X;
  for (int a = 0; a < Cell::n_nodes; ++a)
    X.col(a) = (points.row(nodes[a]) - points.row(nodes[0])).transpose();
  return X;
}

/// N_a and ∂N_a/∂ξ of one type of cell at the points of one rule.
template <class Cell, int n>
struct ShapeTable {
  explicit ShapeTable(const Quadrature<n>& of) : rule(of) {
    for (int p = 0; p < n; ++p) {
      values.col(p) = Cell::values(rule.points.col(p));
      gradients[p] = Cell::gradients(rule.points.col(p));
    }
  }

  Quadrature<n> rule;
  Eigen::Matrix<double, Cell::n_nodes, n> values;
  typename Cell::Gradients gradients[n];
};

template <class Cell>
const auto& stiffness_table() {
  static const ShapeTable<Cell, std::decay_t<decltype(Cell::stiffness_rule())>::size> table(
      Cell::stiffness_rule());
  return table;
}

template <class Cell>
const auto& mass_table() {
  static const ShapeTable<Cell, std::decay_t<decltype(Cell::mass_rule())>::size> table(Cell::mass_rule());
  return table;
}

template <class Cell>
const auto& stress_table() {
  static const ShapeTable<Cell, std::decay_t<decltype(Cell::stress_rule())>::size> table(Cell::stress_rule());
  return table;
}

/// Jacobian of x(ξ): J_ik = ∂x_i/∂ξ_k.
template <class Cell>
Eigen::Matrix3d jacobian(const NodePositions<Cell>& X, const typename Cell::Gradients& gradients) {
  return X.lazyProduct(gradients.transpose());
}

/// Smallest scaled Jacobian over the integration points of a cell; not positive where it is inverted or flat.
template <class Cell>
double smallest_jacobian(const NodePositions<Cell>& X) {
  double smallest = 1;
  for (const auto& gradients : stiffness_table<Cell>().gradients)
    smallest = std::min(smallest, Cell::scaled_jacobian(jacobian<Cell>(X, gradients)));
  for (const auto& gradients : mass_table<Cell>().gradients)
    smallest = std::min(smallest, Cell::scaled_jacobian(jacobian<Cell>(X, gradients)));
  return smallest;
}

/// Smallest scaled Jacobian of each cell, block by block.
std::vector<Eigen::VectorXd> smallest_jacobians(const SolidMesh& mesh);

}  // namespace flexarm::solids
