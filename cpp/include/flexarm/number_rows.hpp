/// @file
/// Rows of numbers in text, their cells separated by commas.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string_view>
#include <vector>

namespace flexarm {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Numbers of some columns, shape (rows, columns), NaN in empty cells. Lines that are empty or begin with `#`
/// are no rows. Empty if a row has not as many cells as `cells`, or one of the columns has a cell that is no
/// number.
/// @throws InvalidParameter if a column is not one of the cells.
std::optional<RowMatrix> number_rows(std::string_view text, int cells, const std::vector<int>& columns);

}  // namespace flexarm
