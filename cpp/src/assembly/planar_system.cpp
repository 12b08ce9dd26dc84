#include "flexarm/assembly/planar_system.hpp"

#include "flexarm/dense.hpp"

namespace flexarm::assembly {

using namespace geometry;
using Eigen::MatrixXd;

bool PlanarSystem::same_coordinates(const PlanarSystem& other) const {
  const auto near = [](const PlaneAxes& a, const PlaneAxes& b) { return a.E.isApprox(b.E, 1e-12); };
  bool same = near(base_, other.base_) && axes_.size() == other.axes_.size() &&
              scalars_.rows() == other.scalars_.rows() && scalars_.cols() == other.scalars_.cols() &&
              scalars_.isApprox(other.scalars_, 1e-12);
  for (std::size_t k = 0; same && k < axes_.size(); ++k) same = near(axes_[k], other.axes_[k]);
  return same;
}

StateIn<2> PlanarSystem::part(const State& state) const {
  StateIn<2> flat;
  flat.t = state.t;
  flat.laws = state.laws;
  const Eigen::Index n_space = state.s.size();
  const auto coordinates = [&](const auto& s) -> VectorXd {
    if (n_scalars() == 0) return VectorXd(0);
    return dense::least_squares(scalars_, s);
  };
  const auto velocities = [&](const VectorXd& v) {
    VectorXd out(n_velocities());
    for (int k = 0; k < n_nodes_; ++k) {
      out.segment<3>(3 * k) = axes_[k].within().transpose() * v.segment<6>(6 * k);
    }
    out.tail(n_scalars()) = coordinates(VectorXd(v.tail(n_space)));
    return out;
  };
  for (int k = 0; k < n_nodes_; ++k) flat.frames.push_back(in_plane(state.frames[k], base_, axes_[k]));
  flat.s = coordinates(state.s);
  flat.v = velocities(state.v);
  flat.v_dot = velocities(state.v_dot);
  flat.a = velocities(state.a);
  flat.multipliers.resize(n_constraints_);
  int row = 0, row_space = 0;
  for (std::size_t k = 0; k < constraints_.size(); ++k) {
    const int rows = constraints_[k].rows(), rows_space = rows == 3 ? 6 : 3;
    flat.multipliers.segment(row, rows) =
        joint_axes_[k].within().topLeftCorner(rows_space, rows).transpose() *
        state.multipliers.segment(row_space, rows_space);
    row += rows;
    row_space += rows_space;
  }
  const auto n_gears = static_cast<Eigen::Index>(gears_.size());
  flat.multipliers.segment(row, n_gears) = state.multipliers.segment(row_space, n_gears);
  flat.multipliers.tail(closings_.cols()) = closings_.transpose() * state.multipliers.tail(closings_.rows());
  return flat;
}

LoadsIn<2> PlanarSystem::part(const Loads& loads) const {
  LoadsIn<2> flat;
  flat.gravity = base_.part(loads.gravity);
  for (const PointLoad& load : loads.points) {
    const PlaneAxes& axes = load.follows ? point_axes_[load.point] : base_;
    flat.points.push_back(
        {load.point, axes.part(load.force), Turn<2>(axes.normal().dot(load.moment)), load.follows});
  }
  if (loads.torques.size() > 0) flat.torques = scalars_.transpose() * loads.torques;
  return flat;
}

State PlanarSystem::embed(const StateIn<2>& state, const State& start) const {
  State full = start;
  full.t = state.t;
  full.laws = state.laws;
  const auto velocities = [&](const VectorXd& v, VectorXd& out) {
    for (int k = 0; k < n_nodes_; ++k) out.segment<6>(6 * k) = axes_[k].within() * v.segment<3>(3 * k);
    out.tail(scalars_.rows()) = scalars_ * v.tail(n_scalars());
  };
  for (int k = 0; k < n_nodes_; ++k) {
    full.frames[k] = in_space(state.frames[k], distance_[k], base_, axes_[k]);
  }
  full.s = scalars_ * state.s;
  velocities(state.v, full.v);
  velocities(state.v_dot, full.v_dot);
  velocities(state.a, full.a);
  int row = 0, row_space = 0;
  for (std::size_t k = 0; k < constraints_.size(); ++k) {
    const int rows = constraints_[k].rows(), rows_space = rows == 3 ? 6 : 3;
    full.multipliers.segment(row_space, rows_space) =
        joint_axes_[k].within().topLeftCorner(rows_space, rows) * state.multipliers.segment(row, rows);
    row += rows;
    row_space += rows_space;
  }
  const auto n_gears = static_cast<Eigen::Index>(gears_.size());
  full.multipliers.segment(row_space, n_gears) = state.multipliers.segment(row, n_gears);
  full.multipliers.tail(closings_.rows()) = closings_ * state.multipliers.tail(closings_.cols());
  return full;
}

}  // namespace flexarm::assembly
