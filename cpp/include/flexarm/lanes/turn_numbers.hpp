/// @file
/// What turned joints change in kept matrices (integrators/woodbury_update.hpp), laid out for arms side by
/// side.
#pragma once

#include <vector>

#include "flexarm/integrators/woodbury_update.hpp"
#include "flexarm/lanes/numbers.hpp"
#include "flexarm/lanes/rows.hpp"

namespace flexarm::lanes {

template <int D>
class TurnNumbersIn {
 public:
  using Update = integrators::WoodburyUpdateIn<D>;

  TurnNumbersIn() = default;
  /// @param unknowns places of those that the matrix has. @param n_rows of W
  TurnNumbersIn(const Update& update, const std::vector<int>& unknowns, int n_rows, int lanes);

  /// @param W rows of W that are asked for
  void set(int lane, const Update& update, const Eigen::MatrixXd& W);

  const Turns& turns() const { return turns_; }

 private:
  std::vector<TurningJoint> joints_;
  Rows scale_, numbers_, G_, W_, E_, factors_, other_factors_;
  Turns turns_{};
};

}  // namespace flexarm::lanes
