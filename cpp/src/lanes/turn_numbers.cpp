#include "flexarm/lanes/turn_numbers.hpp"

namespace flexarm::lanes {

template <int D>
TurnNumbersIn<D>::TurnNumbersIn(const Update& update, const std::vector<int>& unknowns, int n_rows,
                                int lanes) {
  constexpr int n = Update::n, across = Update::across, rows = Update::rows;
  for (const auto& joint : update.joints()) {
    const auto& constraint = update.system().constraints()[static_cast<std::size_t>(joint.constraint)];
    joints_.push_back({constraint.coordinate(), unknowns[static_cast<std::size_t>(joint.node_row)],
                       unknowns[static_cast<std::size_t>(joint.first_row)],
                       constraint.type() == joints::JointType::prismatic});
  }
  const int n_joints = static_cast<int>(joints_.size()), m = 2 * across * n_joints;
  const auto room = [&](Rows& kept, int count) {
    kept = Rows(count, lanes);
    return kept.data();
  };
  turns_ = {.n_joints = n_joints,
            .n_columns = m,
            .n_rows = n_rows,
            .joints = joints_.data(),
            .scale = room(scale_, 1),
            .numbers = room(numbers_, (across * across + n + (n + rows) * across) * n_joints),
            .G = room(G_, m * m),
            .W = room(W_, n_rows * m),
            .E = room(E_, across * across * n_joints),
            .factors = room(factors_, m * m + 2 * m),
            .other_factors = room(other_factors_, m * m + 2 * m)};
}

template <int D>
void TurnNumbersIn<D>::set(int lane, const Update& update, const Eigen::MatrixXd& W) {
  const int m = turns_.n_columns;
  scale_(0, lane) = update.scale();
  int row = 0;
  for (const auto& joint : update.joints()) {
    row = numbers_.put(row, lane, joint.kept);
    row = numbers_.put(row, lane,
                       update.system().constraints()[static_cast<std::size_t>(joint.constraint)].twist());
    row = numbers_.put(row, lane, joint.on_parent);
    row = numbers_.put(row, lane, joint.P);
  }
  G_.put(0, lane, update.G().topLeftCorner(m, m));
  W_.put_blocks(0, lane, W, 0, turns_.n_rows, m);
}

template class TurnNumbersIn<2>;
template class TurnNumbersIn<3>;

}  // namespace flexarm::lanes
