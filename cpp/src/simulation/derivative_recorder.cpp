#include "flexarm/simulation/derivative_recorder.hpp"

#include <algorithm>

#include "flexarm/simulation/reactions.hpp"

namespace flexarm::simulation {
namespace {

using namespace geometry;

/// The columns that have derivatives.
constexpr Transient::Matrix Transient::* columns[] = {
    &Transient::position,     &Transient::velocity,     &Transient::orientation,    &Transient::angular_rate,
    &Transient::joint_angle,  &Transient::joint_rate,   &Transient::drive_angle,    &Transient::drive_rate,
    &Transient::joint_torque, &Transient::motor_torque, &Transient::section_forces, &Transient::base_wrench};

TransientOptions without_energies(TransientOptions options) {
  options.record_energies = false;
  return options;
}

}  // namespace

template <int D>
DerivativeRecorderIn<D>::DerivativeRecorderIn(const SystemIn<D>& system, const InSpace<D>& space,
                                              std::vector<Varied> varied, const TransientOptions& options,
                                              Eigen::Index n, std::vector<Transient>& out)
    : system_(system),
      space_(space),
      varied_(std::move(varied)),
      options_(without_energies(options)),
      out_(out),
      closed_forms_(closed_forms_do()) {
  out_.resize(varied_.size());
  for (Transient& derivative : out_) RecorderIn<D>(system, options_, n, derivative, space);  // makes room
}

template <int D>
void DerivativeRecorderIn<D>::record(Eigen::Index k, const StateIn<D>& state,
                                     const StateDerivative& derivative, const LoadsIn<D>& loads) {
  if (closed_forms_) beside_ = state;
  for (std::size_t p = 0; p < varied_.size(); ++p) {
    out_[p].time[k] = state.t;
    if (!closed_forms_) {
      everything(k, p, state, derivative, loads);
      continue;
    }
    if (options_.record_points) points(k, p, state, derivative);
    if (options_.record_joints) joints(k, p, state, derivative);
  }
}

/// Whether every point sits on the same node in all models, and nothing else is asked for.
template <int D>
bool DerivativeRecorderIn<D>::closed_forms_do() const {
  if (options_.record_rotations || options_.record_forces) return false;
  for (std::size_t i = 0; i < system_.points().size(); ++i) {
    const int node = system_.points()[i].node;
    const auto on_node = [&](const SystemIn<D>& system) {
      return system.points()[i].element < 0 && system.points()[i].node == node;
    };
    const bool all = std::all_of(varied_.begin(), varied_.end(), [&](const Varied& varied) {
      return on_node(*varied.models.plus) && on_node(*varied.models.minus);
    });
    if (!on_node(system_) || !all) return false;
  }
  return true;
}

/// Equations (1), (2).
template <int D>
void DerivativeRecorderIn<D>::points(Eigen::Index k, std::size_t p, const StateIn<D>& state,
                                     const StateDerivative& derivative) {
  constexpr int n = freedoms<D>;
  const Varied& varied = varied_[p];
  const auto column = static_cast<Eigen::Index>(p);
  for (int i = 0; i < static_cast<int>(system_.points().size()); ++i) {
    const auto& at = system_.points()[i];
    const FrameIn<D>& H = state.frames[at.node];
    const Twist<D> v = state.v.template segment<n>(n * at.node);
    const Twist<D> xi = derivative.position.col(column).template segment<n>(n * at.node);
    const Twist<D> dv = derivative.velocity.col(column).template segment<n>(n * at.node);
    const Point<D> o = at.offset.x, u = v.template head<D>() + turn_cross<D>(rotation<D>(v), o);
    const Point<D> dx = xi.template head<D>() + turn_cross<D>(rotation<D>(xi), o);
    const Point<D> du =
        turn_cross<D>(rotation<D>(xi), u) + dv.template head<D>() + turn_cross<D>(rotation<D>(dv), o);
    auto position = out_[p].position.col(k).template segment<3>(3 * i);
    auto velocity = out_[p].velocity.col(k).template segment<3>(3 * i);
    position = space_.arrow(H.R * dx);
    velocity = space_.arrow(H.R * du);
    const Point<D> up = varied.models.plus->points()[i].offset.x;
    const Point<D> down = varied.models.minus->points()[i].offset.x;
    position += (varied.plus.place(i, H * up) - varied.minus.place(i, H * down)) / varied.models.spread();
    velocity +=
        space_.arrow(H.R * turn_cross<D>(rotation<D>(v), Point<D>(up - down))) / varied.models.spread();
  }
}

template <int D>
void DerivativeRecorderIn<D>::joints(Eigen::Index k, std::size_t p, const StateIn<D>& state,
                                     const StateDerivative& derivative) {
  const VariationIn<D>& varied = varied_[p].models;
  const auto column = static_cast<Eigen::Index>(p);
  const int n_scalars = system_.n_scalars(), n_joints = static_cast<int>(system_.joints().size());
  VectorXd motor = VectorXd::Zero(n_joints), joint = VectorXd::Zero(n_joints);
  const auto add = [&](const SystemIn<D>& system, double amount, double sign) {
    beside_.s = state.s + amount * derivative.position.col(column).tail(n_scalars);
    beside_.v.tail(n_scalars) =
        state.v.tail(n_scalars) + amount * derivative.velocity.col(column).tail(n_scalars);
    beside_.v_dot.tail(n_scalars) =
        state.v_dot.tail(n_scalars) + amount * derivative.v_dot.col(column).tail(n_scalars);
    beside_.multipliers = state.multipliers + amount * derivative.multipliers.col(column);
    for (std::size_t law = 0; law < state.laws.size(); ++law) {
      beside_.laws[law].x = state.laws[law].x + amount * derivative.law_x(law, column);
      beside_.laws[law].z = state.laws[law].z + amount * derivative.law_z(law, column);
    }
    motor += sign * motor_torques(system, beside_, true);
    for (int j = 0; j < n_joints; ++j) joint[j] += sign * joint_torque(system, beside_, j);
  };
  add(*varied.plus, varied.up, 1 / varied.spread());
  add(*varied.minus, varied.down, -1 / varied.spread());
  out_[p].motor_torque.col(k) = motor;
  out_[p].joint_torque.col(k) = joint;
  const auto angles = derivative.position.col(column).tail(n_scalars);
  const auto rates = derivative.velocity.col(column).tail(n_scalars);
  for (int j = 0; j < n_joints; ++j) {
    const int theta = system_.joints()[j].theta, phi = system_.joints()[j].phi;
    const bool moves = theta >= 0;
    out_[p].joint_angle(j, k) = moves ? angles[theta] : 0.0;
    out_[p].joint_rate(j, k) = moves ? rates[theta] : 0.0;
    out_[p].drive_angle(j, k) = moves ? angles[phi] : 0.0;
    out_[p].drive_rate(j, k) = moves ? rates[phi] : 0.0;
  }
}

/// By differences of whole records.
template <int D>
void DerivativeRecorderIn<D>::everything(Eigen::Index k, std::size_t p, const StateIn<D>& state,
                                         const StateDerivative& derivative, const LoadsIn<D>& loads) {
  const Varied& varied = varied_[p];
  const auto column = static_cast<Eigen::Index>(p);
  const auto outputs = [&](const SystemIn<D>& system, const InSpace<D>& space, double amount) {
    Transient at;
    RecorderIn<D> recorder(system, options_, 1, at, space);
    recorder.record(0, moved(system_, state, derivative, column, amount), loads);
    return at;
  };
  const Transient up = outputs(*varied.models.plus, varied.plus, varied.models.up);
  const Transient down = outputs(*varied.models.minus, varied.minus, varied.models.down);
  for (const auto member : columns) {
    if ((out_[p].*member).size() == 0) continue;
    (out_[p].*member).col(k) = ((up.*member).col(0) - (down.*member).col(0)) / varied.models.spread();
  }
  if (!options_.record_rotations) return;
  for (Eigen::Index i = 0; i + 4 <= up.orientation.rows(); i += 4) {
    // A quaternion and its opposite are one rotation: the difference is taken between neighbours.
    const Eigen::Vector4d a = up.orientation.col(0).segment<4>(i), b = down.orientation.col(0).segment<4>(i);
    const double sign = a.dot(b) < 0 ? -1 : 1;
    out_[p].orientation.col(k).segment<4>(i) = (a - sign * b) / varied.models.spread();
  }
}

template class DerivativeRecorderIn<2>;
template class DerivativeRecorderIn<3>;

}  // namespace flexarm::simulation
