#include "flexarm/sensitivity/derivative_recorder.hpp"

namespace flexarm::sensitivity {
namespace {

using namespace simulation;

/// The columns that have derivatives.
constexpr Transient::Matrix Transient::* columns[] = {
    &Transient::position,     &Transient::velocity,     &Transient::orientation,    &Transient::angular_rate,
    &Transient::joint_angle,  &Transient::joint_rate,   &Transient::drive_angle,    &Transient::drive_rate,
    &Transient::joint_torque, &Transient::motor_torque, &Transient::section_forces, &Transient::base_wrench};

TransientOptions without_energies(TransientOptions options) {
  options.record_energies = false;
  return options;
}

TransientOptions forces_alone(TransientOptions options) {
  options.record_points = options.record_rotations = options.record_joints = false;
  return options;
}

}  // namespace

template <int D>
DerivativeRecorderIn<D>::DerivativeRecorderIn(const SystemIn<D>& system, const InSpace<D>& space,
                                              std::vector<VariedInSpace<D>> varied,
                                              const TransientOptions& options, Eigen::Index n, Transient& out)
    : system_(system),
      varied_(std::move(varied)),
      options_(without_energies(options)),
      out_(out),
      points_(system, space, varied_),
      joints_(system, variations_of(varied_)),
      forces_(system, variations_of(varied_)) {
  Transient one;
  RecorderIn<D>(system, options_, 1, one, space);  // how many rows there are
  out.time.resize(n);
  const auto n_parameters = static_cast<Eigen::Index>(varied_.size());
  for (const auto member : columns) {
    if ((one.*member).cols() > 0) (out.*member).resize((one.*member).rows() * n_parameters, n);
  }
}

template <int D>
void DerivativeRecorderIn<D>::record(Eigen::Index k, const StateIn<D>& state,
                                     const StateDerivative& derivative, const LoadsIn<D>& loads) {
  out_.time[k] = state.t;
  if (options_.record_points || options_.record_rotations) {
    points_.record(k, options_, state, derivative, out_);
  }
  if (!options_.record_joints && !options_.record_forces) return;
  const bool consistent = options_.has_consistent_forces();
  if (consistent) forces_.find(state, loads, derivative);
  const StateIn<D>& recorded = consistent ? forces_.state() : state;
  const StateDerivative& slopes = consistent ? forces_.derivative() : derivative;
  if (options_.record_joints) joints_.record(k, recorded, slopes, out_);
  if (options_.record_forces) forces(k, recorded, slopes, loads);
}

/// By differences of whole records.
template <int D>
void DerivativeRecorderIn<D>::forces(Eigen::Index k, const StateIn<D>& state,
                                     const StateDerivative& derivative, const LoadsIn<D>& loads) {
  for (std::size_t p = 0; p < varied_.size(); ++p) {
    const VariedInSpace<D>& varied = varied_[p];
    const auto column = static_cast<Eigen::Index>(p);
    const auto outputs = [&](const SystemIn<D>& system, const InSpace<D>& space, double amount) {
      Transient at;
      RecorderIn<D> recorder(system, forces_alone(options_), 1, at, space);
      recorder.write(0, moved(system_, state, derivative, column, amount), loads);
      return at;
    };
    const Transient up = outputs(*varied.variation.plus, varied.plus, varied.variation.up);
    const Transient down = outputs(*varied.variation.minus, varied.minus, varied.variation.down);
    for (const auto member : {&Transient::section_forces, &Transient::base_wrench}) {
      const Eigen::Index rows = (up.*member).rows();
      Eigen::Map<Slopes>((out_.*member).col(k).data(), rows, derivative.size()).col(column) =
          ((up.*member).col(0) - (down.*member).col(0)) / varied.variation.spread();
    }
  }
}

template class DerivativeRecorderIn<2>;
template class DerivativeRecorderIn<3>;

}  // namespace flexarm::sensitivity
