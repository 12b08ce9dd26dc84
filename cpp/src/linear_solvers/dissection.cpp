#include "flexarm/linear_solvers/dissection.hpp"

#include <algorithm>
#include <utility>

namespace flexarm::linear_solvers {
namespace {

using Levels = std::vector<std::vector<int>>;

/// The unknowns that an unknown shares an entry with, in either triangle.
std::vector<std::vector<int>> neighbours(const Eigen::SparseMatrix<double>& A) {
  std::vector<std::vector<int>> graph(static_cast<std::size_t>(A.rows()));
  for (int column = 0; column < A.outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(A, column); it; ++it) {
      const int row = static_cast<int>(it.row());
      graph[row].push_back(column);
      graph[column].push_back(row);
    }
  }
  return graph;
}

/// All that `first` is connected with, by distance from it.
Levels levels_from(int first, const std::vector<std::vector<int>>& graph) {
  std::vector<bool> seen(graph.size(), false);
  seen[first] = true;
  Levels levels = {{first}};
  while (true) {
    std::vector<int> next;
    for (int k : levels.back()) {
      for (int other : graph[k]) {
        if (seen[other]) continue;
        seen[other] = true;
        next.push_back(other);
      }
    }
    if (next.empty()) return levels;
    levels.push_back(std::move(next));
  }
}

/// Parts of about equal size: the last one must not be what happens to be left, for unknowns on their own may
/// be singular where they are regular beside their neighbours, as multipliers are.
void cut(const Levels& levels, int part_size, Dissection& out) {
  std::size_t left = 0;
  for (const auto& level : levels) left += level.size();
  std::size_t parts_left = std::max<std::size_t>(1, left / part_size);
  std::vector<int> part;
  for (const auto& level : levels) {
    const bool separates = parts_left > 1 && part.size() >= left / parts_left;
    auto& taker = separates ? out.separator : part;
    taker.insert(taker.end(), level.begin(), level.end());
    if (!separates) continue;
    left -= part.size() + level.size();
    --parts_left;
    out.parts.push_back(std::exchange(part, {}));
  }
  out.parts.push_back(std::move(part));
}

}  // namespace

Dissection dissect(const Eigen::SparseMatrix<double>& A, int part_size) {
  const auto graph = neighbours(A);
  std::vector<bool> done(graph.size(), false);
  Dissection out;
  for (int k = 0; k < static_cast<int>(graph.size()); ++k) {
    if (done[k]) continue;
    const int outermost = levels_from(k, graph).back().front();
    const Levels levels = levels_from(outermost, graph);
    for (const auto& level : levels) {
      for (int member : level) done[member] = true;
    }
    cut(levels, part_size, out);
  }
  return out;
}

}  // namespace flexarm::linear_solvers
