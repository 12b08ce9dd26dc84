#include "flexarm/sensitivity/joint_slopes.hpp"

namespace flexarm::sensitivity {

using namespace geometry;
using namespace simulation;

template <int D>
JointSlopesIn<D>::JointSlopesIn(const assembly::SystemIn<D>& system,
                                const std::vector<VariationIn<D>>& variations)
    : system_(system), laws_(system, variations) {
  for (Eigen::Index p = 0; p < static_cast<Eigen::Index>(variations.size()); ++p) {
    const VariationIn<D>& one = variations[p];
    for (std::size_t k = 0; k < system.constraints().size(); ++k) {
      const Twist<D> slope =
          (one.plus->constraints()[k].twist() - one.minus->constraints()[k].twist()) / one.spread();
      if (!slope.isZero(0)) turned_.push_back({k, p, slope});
    }
    for (int k = 0; k < system.n_scalars(); ++k) {
      const double slope = (one.plus->scalar_inertia()[k] - one.minus->scalar_inertia()[k]) / one.spread();
      if (slope != 0) rotors_.push_back({k, p, slope});
    }
    for (std::size_t k = 0; k < system.gears().size(); ++k) {
      const auto &plus = one.plus->gears()[k].transmission, &minus = one.minus->gears()[k].transmission;
      if (!(plus == minus)) geared_.push_back({k, p, &plus, &minus, one.spread()});
    }
  }
}

template <int D>
void JointSlopesIn<D>::record(Eigen::Index k, const assembly::StateIn<D>& state,
                              const StateDerivative& derivative, Transient& out) {
  const int offset = system_.scalar_offset();
  laws_.evaluate(state, true);
  const auto row = [&](Transient::Matrix& columns, std::size_t joint) {
    return Eigen::Map<Eigen::RowVectorXd>(
        columns.col(k).data() + static_cast<Eigen::Index>(joint) * derivative.size(), derivative.size());
  };
  for (std::size_t j = 0; j < system_.joints().size(); ++j) {
    const int theta = system_.joints()[j].theta, phi = system_.joints()[j].phi;
    if (theta < 0) {
      for (auto* columns : {&out.joint_angle, &out.joint_rate, &out.drive_angle, &out.drive_rate,
                            &out.joint_torque, &out.motor_torque}) {
        row(*columns, j).setZero();
      }
      continue;
    }
    row(out.joint_angle, j) = derivative.position.row(offset + theta);
    row(out.joint_rate, j) = derivative.velocity.row(offset + theta);
    row(out.drive_angle, j) = derivative.position.row(offset + phi);
    row(out.drive_rate, j) = derivative.velocity.row(offset + phi);
    torque_about(j, state, derivative);
    row(out.joint_torque, j) = torque_;
    motor_ = system_.scalar_inertia()[phi] * derivative.v_dot.row(offset + phi);
    for (const Rotor& rotor : rotors_) {
      if (rotor.scalar == phi) motor_[rotor.column] += rotor.slope * state.v_dot[offset + phi];
    }
    add_laws(phi, derivative);
    for (std::size_t i = 0; i < system_.constraints().size(); ++i) {
      if (system_.constraints()[i].coordinate() != phi) continue;
      torque_about(i, state, derivative);
      motor_ += torque_;
    }
    add_gears(phi, state, derivative);
    row(out.motor_torque, j) = motor_;
  }
}

/// −d(ξᵀ λ) of a joint with a coordinate.
template <int D>
void JointSlopesIn<D>::torque_about(std::size_t joint, const assembly::StateIn<D>& state,
                                    const StateDerivative& derivative) {
  const auto& constraint = system_.constraints()[joint];
  const int first = system_.first_row(static_cast<int>(joint));
  torque_.setZero(derivative.size());
  if (constraint.coordinate() < 0) return;
  for (int i = 0; i < constraint.rows(); ++i) {
    const double component = constraint.twist()[i];
    if (component != 0) torque_ -= component * derivative.multipliers.row(first + i);
  }
  for (const Turned& turned : turned_) {
    if (turned.joint != joint) continue;
    torque_[turned.column] -= turned.slope.dot(state.multipliers.template segment<freedoms<D>>(first));
  }
}

/// ± dQ of the laws that act on a coordinate.
template <int D>
void JointSlopesIn<D>::add_laws(int scalar, const StateDerivative& derivative) {
  const int offset = system_.scalar_offset();
  for (std::size_t k = 0; k < system_.laws().size(); ++k) {
    const auto& law = system_.laws()[k];
    if (law.plus != scalar && law.minus != scalar) continue;
    const double sign = law.plus == scalar ? 1 : -1;
    const double stiffness = sign * laws_.response(k).stiffness, damping = sign * laws_.response(k).damping;
    motor_ += stiffness * derivative.position.row(offset + law.plus) +
              damping * derivative.velocity.row(offset + law.plus);
    if (law.minus >= 0) {
      motor_ -= stiffness * derivative.position.row(offset + law.minus) +
                damping * derivative.velocity.row(offset + law.minus);
    }
    if (law.of >= 0) {
      motor_ += sign * (laws_.response(k).force_by_y * derivative.position.row(offset + law.of) +
                        laws_.response(k).force_by_y_rate * derivative.velocity.row(offset + law.of));
    }
    motor_ += sign * laws_.force_of_the_past(k, derivative);
  }
}

/// d(ψ' λ) of the gears whose input a coordinate is, −dλ of those whose output it is.
template <int D>
void JointSlopesIn<D>::add_gears(int scalar, const assembly::StateIn<D>& state,
                                 const StateDerivative& derivative) {
  int row = system_.first_row(static_cast<int>(system_.constraints().size()));
  for (std::size_t k = 0; k < system_.gears().size(); ++k, ++row) {
    const auto& gear = system_.gears()[k];
    if (gear.output == scalar) motor_ -= derivative.multipliers.row(row);
    if (gear.input != scalar) continue;
    const double s = state.s[gear.input], lambda = state.multipliers[row];
    const auto psi = gear.transmission(s);
    motor_ += psi.second * lambda * derivative.position.row(system_.scalar_offset() + gear.input) +
              psi.first * derivative.multipliers.row(row);
    for (const Geared& other : geared_) {
      if (other.gear != k) continue;
      motor_[other.column] += ((*other.plus)(s).first - (*other.minus)(s).first) / other.spread * lambda;
    }
  }
}

template class JointSlopesIn<2>;
template class JointSlopesIn<3>;

}  // namespace flexarm::sensitivity
