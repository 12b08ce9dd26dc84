#include "flexarm/linear_solvers/supernodes.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>

namespace flexarm::linear_solvers {
namespace {

using Ints = std::vector<int>;
using Pattern = Eigen::SparseMatrix<double>;

/// A number that looks random, for sums that tell sets of indices apart (SplitMix64).
std::uint64_t scrambled(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// First columns of the runs of columns that have equal neighbours, themselves among them; at the end n.
Ints equal_runs(const LowerTriangle& A) {
  std::vector<std::uint64_t> sum(static_cast<std::size_t>(A.cols()));
  for (int j = 0; j < A.cols(); ++j) {
    sum[j] += scrambled(j);
    for (LowerTriangle::InnerIterator it(A, j); it; ++it) {
      if (it.row() == j) continue;
      sum[j] += scrambled(it.row());
      sum[it.row()] += scrambled(j);
    }
  }
  Ints starts;
  for (int j = 0; j < A.cols(); ++j)
    if (j == 0 || sum[j] != sum[j - 1]) starts.push_back(j);
  starts.push_back(static_cast<int>(A.cols()));
  return starts;
}

/// Pattern of the runs, lower triangle.
Pattern pattern_of_runs(const LowerTriangle& A, const Ints& starts) {
  const int n = static_cast<int>(starts.size()) - 1;
  Ints run(static_cast<std::size_t>(A.cols()));
  for (int k = 0; k < n; ++k) std::fill(run.begin() + starts[k], run.begin() + starts[k + 1], k);
  const auto each = [&](int k, auto&& take) {
    take(k);
    int last = k;
    for (LowerTriangle::InnerIterator it(A, starts[k]); it; ++it)
      if (run[it.row()] > last) take(last = run[it.row()]);
  };
  Pattern B(n, n);
  Eigen::VectorXi length = Eigen::VectorXi::Zero(n);
  for (int k = 0; k < n; ++k) each(k, [&](int) { ++length[k]; });
  B.reserve(length);
  for (int k = 0; k < n; ++k) each(k, [&](int row) { B.insert(row, k) = 1; });
  B.makeCompressed();
  return B;
}

/// Both triangles without the diagonal, in the given order.
struct Graph {
  std::vector<std::ptrdiff_t> start;
  Ints neighbours;

  Graph(const Pattern& A, const Ints& order) : start(order.size() + 1, 0) {
    Ints place(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = static_cast<int>(k);
    const auto each = [&](auto&& take) {
      for (int j = 0; j < A.cols(); ++j)
        for (Pattern::InnerIterator it(A, j); it; ++it)
          if (it.row() != j) {
            take(place[j], place[it.row()]);
            take(place[it.row()], place[j]);
          }
    };
    each([&](int a, int) { ++start[a + 1]; });
    std::partial_sum(start.begin(), start.end(), start.begin());
    neighbours.resize(start.back());
    std::vector<std::ptrdiff_t> next(start.begin(), start.end() - 1);
    each([&](int a, int b) { neighbours[next[a]++] = b; });
  }
  template <class Take>
  void each(int k, Take&& take) const {
    for (auto i = start[k]; i < start[k + 1]; ++i) take(neighbours[i]);
  }
  int size() const { return static_cast<int>(start.size()) - 1; }
};

/// Elimination tree: the first row below the diagonal of each column of L; −1 where there is none.
Ints elimination_tree(const Graph& graph) {
  Ints parent(graph.size(), -1), ancestor(graph.size(), -1);
  for (int k = 0; k < graph.size(); ++k)
    graph.each(k, [&](int i) {
      while (i >= 0 && i < k) {
        const int next = ancestor[i];
        ancestor[i] = k;
        if (next < 0) parent[i] = k;
        i = next;
      }
    });
  return parent;
}

/// Children before their parents, subtrees together.
Ints post_order(const Ints& parent) {
  const int n = static_cast<int>(parent.size());
  Ints child(n, -1), next(n, -1), order, stack;
  for (int k = n - 1; k >= 0; --k)
    if (parent[k] >= 0) next[k] = std::exchange(child[parent[k]], k);
  order.reserve(n);
  for (int root = 0; root < n; ++root) {
    if (parent[root] >= 0) continue;
    stack.push_back(root);
    while (!stack.empty()) {
      const int k = stack.back();
      if (child[k] >= 0) {
        stack.push_back(std::exchange(child[k], -1));
        continue;
      }
      stack.pop_back();
      order.push_back(k);
      if (!stack.empty()) child[stack.back()] = next[k];
    }
  }
  return order;
}

/// Weight of the rows of each column of L, the diagonal among them: row by row, along the tree.
Ints column_weights(const Graph& graph, const Ints& parent, const Ints& weight) {
  Ints total(weight), seen(graph.size(), -1);
  for (int k = 0; k < graph.size(); ++k) {
    seen[k] = k;
    graph.each(k, [&](int i) {
      for (; i < k && seen[i] != k; i = parent[i]) {
        seen[i] = k;
        total[i] += weight[k];
      }
    });
  }
  return total;
}

/// Whether a supernode of that many columns may have that part of zeros: a few cost less than short kernels.
bool worthwhile(double columns, double zeros) {
  if (columns <= 12) return true;
  if (columns <= 32) return zeros < 0.3;
  if (columns <= 96) return zeros < 0.1;
  return zeros < 0.04;
}

/// Runs of columns, each with the supernode of its last column's parent.
struct Runs {
  Ints first, parent;
};

/// Columns with the same rows below, joined further with the parent that follows them where that is
/// worthwhile.
Runs join(const Ints& parent, const Ints& weight, const Ints& total) {
  struct Node {
    int first, last;
    double columns, height, zeros;  // height: with the columns themselves
    double size() const { return columns * height - columns * (columns - 1) / 2; }
  };
  std::vector<Node> nodes;
  const int n = static_cast<int>(parent.size());
  for (int k = 0; k < n; ++k) {
    Node node{k, k, double(weight[k]), double(total[k]), 0};
    if (k > 0 && parent[k - 1] == k && total[k - 1] == total[k] + weight[k - 1]) {
      Node& last = nodes.back();
      last.last = k;
      last.columns += weight[k];
      continue;
    }
    nodes.push_back(node);
  }
  std::vector<Node> joined;
  for (Node node : nodes) {
    while (!joined.empty()) {
      const Node& child = joined.back();
      if (parent[child.last] < node.first || parent[child.last] > node.last) break;
      Node both{child.first, node.last, child.columns + node.columns, child.columns + node.height, 0};
      both.zeros = child.zeros + node.zeros + both.size() - child.size() - node.size();
      if (!worthwhile(both.columns, both.zeros / both.size())) break;
      node = both;
      joined.pop_back();
    }
    joined.push_back(node);
  }
  Runs runs;
  Ints node_of(n);
  for (std::size_t s = 0; s < joined.size(); ++s) {
    runs.first.push_back(joined[s].first);
    std::fill(node_of.begin() + joined[s].first, node_of.begin() + joined[s].last + 1, static_cast<int>(s));
  }
  for (const Node& node : joined) {
    const int above = parent[node.last];
    runs.parent.push_back(above < 0 ? -1 : node_of[above]);
  }
  runs.first.push_back(n);
  return runs;
}

/// Rows below each run, from those of the graph and of its children.
std::vector<Ints> rows_below(const Graph& graph, const Runs& runs) {
  const std::size_t n = runs.parent.size();
  std::vector<Ints> rows(n), children(n);
  Ints seen(graph.size(), -1);
  for (std::size_t s = 0; s < n; ++s) {
    const int end = runs.first[s + 1];
    const auto take = [&](int row) {
      if (row < end || seen[row] == end) return;
      seen[row] = end;
      rows[s].push_back(row);
    };
    for (int k = runs.first[s]; k < end; ++k) graph.each(k, take);
    for (const int child : children[s])
      for (const int row : rows[child]) take(row);
    std::sort(rows[s].begin(), rows[s].end());
    if (runs.parent[s] >= 0) children[runs.parent[s]].push_back(static_cast<int>(s));
  }
  return rows;
}

template <class T>
std::vector<T> reordered(const std::vector<T>& values, const Ints& order) {
  std::vector<T> out;
  out.reserve(order.size());
  for (const int k : order) out.push_back(values[k]);
  return out;
}

}  // namespace

Supernodes supernodes(const LowerTriangle& A) {
  const Ints starts = equal_runs(A);
  const Pattern pattern = pattern_of_runs(A, starts);
  Supernodes out;
  out.found = fill_ordering(pattern);
  Ints order = out.found.order;
  order = reordered(order, post_order(elimination_tree(Graph(pattern, order))));
  const Graph graph(pattern, order);
  const Ints parent = elimination_tree(graph);
  Ints weight, place = {0};
  for (const int k : order) {
    weight.push_back(starts[k + 1] - starts[k]);
    place.push_back(place.back() + weight.back());
    for (int j = starts[k]; j < starts[k + 1]; ++j) out.order.push_back(j);
  }
  const Ints total = column_weights(graph, parent, weight);
  for (std::size_t k = 0; k < total.size(); ++k)
    for (int j = 0; j < weight[k]; ++j) {
      out.entries += total[k] - j;
      out.operations += double(total[k] - j) * (total[k] - j);
    }
  const Runs runs = join(parent, weight, total);
  out.parent = runs.parent;
  for (const int k : runs.first) out.first.push_back(place[k]);
  out.row_start = {0};
  for (const Ints& rows : rows_below(graph, runs)) {
    for (const int k : rows)
      for (int j = place[k]; j < place[k + 1]; ++j) out.rows.push_back(j);
    out.row_start.push_back(static_cast<std::ptrdiff_t>(out.rows.size()));
  }
  const double blocks = double(A.cols()) / pattern.cols();
  const auto in_unknowns = [&](double entries) {
    return entries > 0 ? blocks * blocks * entries - (blocks - 1) / 2 * A.cols() : 0;
  };
  out.found.entries_amd = in_unknowns(out.found.entries_amd);
  out.found.entries_metis = in_unknowns(out.found.entries_metis);
  (out.found.metis ? out.found.entries_metis : out.found.entries_amd) = out.entries;
  return out;
}

}  // namespace flexarm::linear_solvers
