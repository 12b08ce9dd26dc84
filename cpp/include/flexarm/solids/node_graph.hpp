/// @file
/// Which points share a cell, from which the pattern of the assembled matrices follows without sorting any
/// entry.
#pragma once

#include <vector>

#include "flexarm/solids/mesh.hpp"

namespace flexarm::solids {

/// For each point the points of no lower number that share a cell with it, ascending: the rows below the
/// diagonal of its column. A point of a cell comes first itself; a point of no cell has an empty column.
struct NodeGraph {
  std::vector<std::ptrdiff_t> start;  // n_points + 1
  std::vector<int> neighbours;

  std::ptrdiff_t count(Eigen::Index point) const {
    return start[static_cast<std::size_t>(point) + 1] - start[static_cast<std::size_t>(point)];
  }
  /// Place of `neighbour` in the column of `point`, which it must be in.
  std::ptrdiff_t place(int point, int neighbour) const;
};

NodeGraph node_graph(const SolidMesh& mesh, int n_threads);

}  // namespace flexarm::solids
