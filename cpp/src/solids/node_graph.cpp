#include "flexarm/solids/node_graph.hpp"

#include <algorithm>

#include "flexarm/solids/parallel.hpp"

namespace flexarm::solids {
namespace {

using Offsets = std::vector<std::ptrdiff_t>;

/// Sums up counts that stand one place behind their own.
void accumulate(Offsets& start) {
  for (std::size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
}

/// The cells around each point, as (block, cell).
struct Incidence {
  Offsets start;
  std::vector<std::pair<int, int>> cells;
};

Incidence incidence(const SolidMesh& mesh) {
  Incidence around;
  around.start.assign(static_cast<std::size_t>(mesh.n_points()) + 1, 0);
  for (const CellBlock& block : mesh.blocks())
    for (const int node : block.nodes.reshaped()) ++around.start[static_cast<std::size_t>(node) + 1];
  accumulate(around.start);
  around.cells.resize(static_cast<std::size_t>(around.start.back()));
  Offsets next = around.start;
  for (std::size_t b = 0; b < mesh.blocks().size(); ++b) {
    const CellNodes& nodes = mesh.blocks()[b].nodes;
    for (Eigen::Index c = 0; c < nodes.rows(); ++c)
      for (const int node : nodes.row(c)) {
        const auto place = static_cast<std::size_t>(next[static_cast<std::size_t>(node)]++);
        around.cells[place] = {static_cast<int>(b), static_cast<int>(c)};
      }
  }
  return around;
}

/// Columns of the points [begin, end), and their lengths into `count`.
std::vector<int> columns(const SolidMesh& mesh, const Incidence& around, int begin, int end,
                         std::ptrdiff_t* count) {
  std::vector<int> found, seen_by(static_cast<std::size_t>(mesh.n_points()), -1);
  for (int point = begin; point < end; ++point) {
    const auto first = found.size();
    for (auto i = around.start[static_cast<std::size_t>(point)];
         i < around.start[static_cast<std::size_t>(point) + 1]; ++i) {
      const auto [block, cell] = around.cells[static_cast<std::size_t>(i)];
      for (const int node : mesh.blocks()[static_cast<std::size_t>(block)].nodes.row(cell)) {
        if (node < point || seen_by[static_cast<std::size_t>(node)] == point) continue;
        seen_by[static_cast<std::size_t>(node)] = point;
        found.push_back(node);
      }
    }
    std::sort(found.begin() + static_cast<std::ptrdiff_t>(first), found.end());
    count[point] = static_cast<std::ptrdiff_t>(found.size() - first);
  }
  return found;
}

}  // namespace

std::ptrdiff_t NodeGraph::place(int point, int neighbour) const {
  const auto begin = neighbours.begin() + start[static_cast<std::size_t>(point)];
  return std::lower_bound(begin, neighbours.begin() + start[static_cast<std::size_t>(point) + 1], neighbour) -
         begin;
}

NodeGraph node_graph(const SolidMesh& mesh, int n_threads) {
  const Incidence around = incidence(mesh);
  const int n_points = static_cast<int>(mesh.n_points());
  NodeGraph graph;
  graph.start.assign(static_cast<std::size_t>(n_points) + 1, 0);
  std::vector<std::vector<int>> parts(static_cast<std::size_t>(n_threads));
  in_parallel(n_threads, [&](int t) {
    const auto [begin, end] = part_of<std::ptrdiff_t>(0, n_points, t, n_threads);
    parts[static_cast<std::size_t>(t)] =
        columns(mesh, around, static_cast<int>(begin), static_cast<int>(end), graph.start.data() + 1);
  });
  accumulate(graph.start);
  graph.neighbours.reserve(static_cast<std::size_t>(graph.start.back()));
  for (const auto& part : parts) graph.neighbours.insert(graph.neighbours.end(), part.begin(), part.end());
  return graph;
}

}  // namespace flexarm::solids
