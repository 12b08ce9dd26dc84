/// @file
/// Cuts the graph of a matrix into parts that do not touch one another.
///
/// Taken in the order of their distance from an outermost unknown, unknowns fall into levels, and each level
/// separates those before it from those behind. Every now and then a level becomes a separator: nested
/// dissection without the nesting, which suits chains. Source: [George1981, chapters 4 and 8].
#pragma once

#include <Eigen/SparseCore>
#include <vector>

namespace flexarm::linear_solvers {

struct Dissection {
  std::vector<std::vector<int>> parts;  ///< unknowns of each; no entry of the matrix joins two parts
  std::vector<int> separator;           ///< all others
};

/// @param part_size parts get about so many unknowns, or up to twice as many where there is no more than one.
Dissection dissect(const Eigen::SparseMatrix<double>& A, int part_size);

}  // namespace flexarm::linear_solvers
