#include "flexarm/solids/assemble.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "flexarm/errors.hpp"
#include "flexarm/solids/cell_matrices.hpp"
#include "flexarm/solids/node_graph.hpp"
#include "flexarm/solids/parallel.hpp"

namespace flexarm::solids {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;

/// Pattern of K: three columns a point, lower triangle of 3 × 3 blocks.
void fill_stiffness_column(SparseMatrix& K, const NodeGraph& graph, int point) {
  const int* neighbours = graph.neighbours.data() + graph.start[static_cast<std::size_t>(point)];
  for (int j = 0; j < 3; ++j) {
    int* row = K.innerIndexPtr() + K.outerIndexPtr()[3 * point + j];
    for (std::ptrdiff_t k = 0; k < graph.count(point); ++k)
      for (int i = k == 0 ? j : 0; i < 3; ++i) *row++ = 3 * neighbours[k] + i;
  }
}

/// Pattern of M: the axes stand apart.
void fill_mass_column(SparseMatrix& M, const NodeGraph& graph, int point) {
  const int* neighbours = graph.neighbours.data() + graph.start[static_cast<std::size_t>(point)];
  for (int j = 0; j < 3; ++j) {
    const int begin = M.outerIndexPtr()[3 * point + j], end = M.outerIndexPtr()[3 * point + j + 1];
    for (int k = 0; k < end - begin; ++k) M.innerIndexPtr()[begin + k] = 3 * neighbours[k] + j;
  }
}

/// Room for columns of the given lengths, zero.
template <class Length>
SparseMatrix with_columns(Index n, Length length) {
  SparseMatrix A(n, n);
  std::ptrdiff_t total = 0;
  for (Index column = 0; column < n; ++column) {
    A.outerIndexPtr()[column] = static_cast<int>(total);
    total += length(column);
    if (total > std::numeric_limits<int>::max())
      throw InvalidParameter(
          "the mesh of " + std::to_string(n / 3) +
          " points is too large: its stiffness has more entries than 32-bit indices count");
  }
  A.outerIndexPtr()[n] = static_cast<int>(total);
  A.resizeNonZeros(total);
  std::fill_n(A.valuePtr(), total, 0.0);
  return A;
}

/// What threads add up; each owns some points and their columns.
class Sums {
 public:
  Sums(const SolidMesh& mesh, bool lumped, int n_threads)
      : n_threads_(n_threads), lumped_(lumped), graph_(node_graph(mesh, n_threads)) {
    sums_.K = with_columns(mesh.n_dof(), [&](Index dof) {
      const std::ptrdiff_t n = graph_.count(dof / 3);
      return n == 0 ? 0 : 3 * n - dof % 3;
    });
    sums_.M = with_columns(mesh.n_dof(), [&](Index dof) {
      return lumped ? std::min<std::ptrdiff_t>(1, graph_.count(dof / 3)) : graph_.count(dof / 3);
    });
    in_parallel(n_threads, [&](int t) {
      const auto [begin, end] = part_of<Index>(0, mesh.n_points(), t, n_threads);
      for (Index point = begin; point < end; ++point) {
        fill_stiffness_column(sums_.K, graph_, static_cast<int>(point));
        fill_mass_column(sums_.M, graph_, static_cast<int>(point));
      }
    });
  }

  /// Equation (1) for one cell, as far as it meets the columns of thread t.
  template <class Cell>
  void add(const int* nodes, const Stiffness<Cell>& K, const Mass<Cell>& m, int t) {
    bool owned[Cell::n_nodes];
    for (int a = 0; a < Cell::n_nodes; ++a) owned[a] = owns(t, nodes[a]);
    for (int b = 0; b < Cell::n_nodes; ++b) {
      for (int a = b; a < Cell::n_nodes; ++a) {
        const Matrix3d block = K.template block<3, 3>(3 * a, 3 * b);
        if (nodes[a] >= nodes[b]) {
          if (owned[b]) add(nodes[a], nodes[b], block, m(a, b));
        } else if (owned[a]) {
          add(nodes[b], nodes[a], block.transpose(), m(a, b));
        }
        // A cell that uses a point twice, as a collapsed hexahedron: the block above the diagonal too.
        if (a != b && nodes[a] == nodes[b] && owned[a]) add(nodes[b], nodes[a], block.transpose(), m(a, b));
      }
    }
  }

  SolidMatrices take() { return std::move(sums_); }

 private:
  /// Runs of 16 points in turn, so that the points of neighbouring cells belong to all threads.
  bool owns(int t, int point) const { return (point >> 4) % n_threads_ == t; }

  void add(int row, int column, const Matrix3d& block, double m) {
    const std::ptrdiff_t place = graph_.place(column, row);
    for (int j = 0; j < 3; ++j) {
      double* values = sums_.K.valuePtr() + sums_.K.outerIndexPtr()[3 * column + j] + 3 * place - j;
      for (int i = place == 0 ? j : 0; i < 3; ++i) values[i] += block(i, j);
    }
    if (lumped_ && row != column) return;
    for (int j = 0; j < 3; ++j) sums_.M.valuePtr()[sums_.M.outerIndexPtr()[3 * column + j] + place] += m;
  }

  int n_threads_;
  bool lumped_;
  NodeGraph graph_;
  SolidMatrices sums_;
};

template <class Cell>
struct CellMatrices {
  Stiffness<Cell> K;
  Mass<Cell> m;
};

template <class Cell>
CellMatrices<Cell> cell_matrices(const SolidMesh& mesh, std::size_t block, Index cell, bool lump) {
  return with_positions<Cell>(
      mesh, block, cell, [&](const NodePositions<Cell>& X, const SolidMaterial& material) {
        CellMatrices<Cell> matrices{stiffness<Cell>(X, Lame(material)), mass<Cell>(X, material.density)};
        if (lump) matrices.m = lumped<Cell>(matrices.m).asDiagonal();
        return matrices;
      });
}

/// Batches of about 8 MB of cell matrices: computed by all threads, then added by all threads.
template <class Cell>
void add_block(const SolidMesh& mesh, std::size_t block, bool lump, int n_threads, Sums& sums) {
  const CellBlock& cells = mesh.blocks()[block];
  const Index batch = std::min<Index>(cells.n_cells(), (8 << 20) / sizeof(CellMatrices<Cell>));
  std::vector<CellMatrices<Cell>> matrices(static_cast<std::size_t>(batch));
  for (Index begin = 0; begin < cells.n_cells(); begin += batch) {
    const Index end = std::min(begin + batch, cells.n_cells());
    in_parallel(n_threads, [&](int t) {
      const auto [first, last] = part_of(begin, end, t, n_threads);
      for (Index c = first; c < last; ++c)
        matrices[static_cast<std::size_t>(c - begin)] = cell_matrices<Cell>(mesh, block, c, lump);
    });
    in_parallel(n_threads, [&](int t) {
      for (Index c = begin; c < end; ++c) {
        const auto& [K, m] = matrices[static_cast<std::size_t>(c - begin)];
        sums.add<Cell>(cells.nodes.row(c).data(), K, m, t);
      }
    });
  }
}

}  // namespace

SolidMatrices assemble(const SolidMesh& mesh, bool lumped, int n_threads) {
  n_threads = thread_count(n_threads);
  Sums sums(mesh, lumped, n_threads);
  for (std::size_t block = 0; block < mesh.blocks().size(); ++block)
    with_cell(mesh.blocks()[block].type,
              [&]<class Cell>(Cell) { add_block<Cell>(mesh, block, lumped, n_threads, sums); });
  return sums.take();
}

}  // namespace flexarm::solids
