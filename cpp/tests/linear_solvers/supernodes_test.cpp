#include "flexarm/linear_solvers/supernodes.hpp"

#include <doctest/doctest.h>

#include <numeric>
#include <set>

#include "patterns.hpp"

namespace flexarm::tests::supernodes_test {

using flexarm::linear_solvers::Supernodes;
using flexarm::linear_solvers::supernodes;

namespace {

using Rows = std::set<int>;

/// Rows below the diagonal in every column of L, by elimination of the graph: what a column couples, it
/// couples with one another.
std::vector<Rows> symbolic_factor(const SparseMatrix& A, const std::vector<int>& order) {
  const std::size_t n = order.size();
  std::vector<int> place(n);
  for (std::size_t k = 0; k < n; ++k) place[order[k]] = static_cast<int>(k);
  std::vector<Rows> columns(n);
  for (int j = 0; j < A.cols(); ++j)
    for (SparseMatrix::InnerIterator it(A, j); it; ++it) {
      const auto [column, row] = std::minmax(place[j], place[it.row()]);
      if (column != row) columns[column].insert(row);
    }
  for (Rows& column : columns)
    for (auto row = column.begin(); row != column.end(); ++row)
      columns[*row].insert(std::next(row), column.end());
  return columns;
}

/// Rows below a supernode by the last of its columns.
std::vector<int> rows_of(const Supernodes& nodes, int s) {
  return {nodes.rows.begin() + nodes.row_start[s], nodes.rows.begin() + nodes.row_start[s + 1]};
}

int supernode_of(const Supernodes& nodes, int k) {
  return static_cast<int>(std::upper_bound(nodes.first.begin(), nodes.first.end(), k) - nodes.first.begin()) -
         1;
}

void check_against_elimination(const SparseMatrix& A) {
  const Supernodes nodes = supernodes(A);
  const int n = static_cast<int>(A.cols());
  std::vector<int> sorted = nodes.order, all(static_cast<std::size_t>(n));
  std::sort(sorted.begin(), sorted.end());
  std::iota(all.begin(), all.end(), 0);
  REQUIRE(sorted == all);
  REQUIRE(static_cast<int>(nodes.first.size()) == nodes.count() + 1);
  CHECK(nodes.first.front() == 0);
  CHECK(nodes.first.back() == n);
  const std::vector<Rows> L = symbolic_factor(A, nodes.order);
  double entries = 0, operations = 0;
  for (const Rows& column : L) {
    const double height = 1.0 + static_cast<double>(column.size());
    entries += height;
    operations += height * height;
  }
  CHECK(nodes.entries == entries);
  CHECK(nodes.operations == operations);
  for (int s = 0; s < nodes.count(); ++s) {
    REQUIRE(nodes.n_columns(s) > 0);
    const int last = nodes.first[s + 1] - 1;
    const std::vector<int> rows = rows_of(nodes, s);
    CHECK(rows == std::vector<int>(L[last].begin(), L[last].end()));
    CHECK(nodes.parent[s] == (rows.empty() ? -1 : supernode_of(nodes, rows.front())));
    for (int k = nodes.first[s]; k < last; ++k)
      for (const int row : L[k]) {  // nothing is lost by holding the columns together
        const bool held = row <= last || L[last].contains(row);
        CHECK(held);
      }
  }
}

/// The children of each supernode come right before it, with all that stands under them: matrices that wait
/// for their parents are then a stack.
bool subtrees_stand_together(const Supernodes& nodes) {
  std::vector<int> waiting;
  for (int s = 0; s < nodes.count(); ++s) {
    while (!waiting.empty() && nodes.parent[waiting.back()] == s) waiting.pop_back();
    for (const int w : waiting)
      if (nodes.parent[w] == s) return false;
    if (nodes.parent[s] >= 0) waiting.push_back(s);
  }
  return waiting.empty();
}

Edges chain(int n) {
  Edges edges;
  for (int k = 1; k < n; ++k) edges.emplace_back(k, k - 1);
  return edges;
}

}  // namespace

TEST_CASE("Rows, tree and counts of random matrices are those of a graph eliminated point by point") {
  Random random(7);
  for (int trial = 0; trial < 150; ++trial) {
    CAPTURE(trial);
    const SparseMatrix A = random_matrix(random, trial % 3 == 0 ? 1.0 : trial % 3 == 1 ? 3.0 : 12.0);
    check_against_elimination(A);
    CHECK(subtrees_stand_together(supernodes(A)));
  }
}

TEST_CASE("Matrices of one shape: diagonal, chain, star, full, and the cells of a grid") {
  Random random(8);
  const auto ones = [](int n) { return std::vector<int>(static_cast<std::size_t>(n), 1); };
  Edges star, all, grid;
  for (int k = 1; k < 30; ++k) {
    star.emplace_back(k, 0);
    for (int j = 0; j < k; ++j) all.emplace_back(k, j);
  }
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) {
      if (i > 0) grid.emplace_back(12 * i + j, 12 * i + j - 12);
      if (j > 0) grid.emplace_back(12 * i + j, 12 * i + j - 1);
    }
  for (const SparseMatrix& A : {matrix_of({}, ones(5), random), matrix_of(chain(30), ones(30), random),
                                matrix_of(star, ones(30), random), matrix_of(all, ones(30), random),
                                matrix_of(grid, ones(144), random)}) {
    CAPTURE(A.nonZeros());
    check_against_elimination(A);
    CHECK(subtrees_stand_together(supernodes(A)));
  }
  CHECK(supernodes(matrix_of(all, ones(30), random)).count() == 1);
  CHECK(supernodes(matrix_of({}, ones(5), random)).count() == 5);
}

TEST_CASE("The unknowns of a point are eliminated one after the other") {
  Random random(9);
  const int points = 20;
  const Supernodes nodes = supernodes(matrix_of(chain(points), std::vector<int>(points, 3), random));
  for (int k = 0; k < 3 * points; k += 3) {
    CHECK(nodes.order[k] % 3 == 0);
    CHECK(nodes.order[k + 1] == nodes.order[k] + 1);
    CHECK(nodes.order[k + 2] == nodes.order[k] + 2);
  }
}

}  // namespace flexarm::tests::supernodes_test
