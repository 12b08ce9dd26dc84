#include "flexarm/simulation/differentiated_run.hpp"

#include <cmath>

#include "flexarm/simulation/recorder.hpp"

namespace flexarm::simulation {
namespace {

/// The columns that have derivatives.
constexpr Transient::Matrix Transient::* columns[] = {
    &Transient::position,     &Transient::velocity,     &Transient::orientation,    &Transient::angular_rate,
    &Transient::joint_angle,  &Transient::joint_rate,   &Transient::drive_angle,    &Transient::drive_rate,
    &Transient::joint_torque, &Transient::motor_torque, &Transient::section_forces, &Transient::base_wrench};

TransientOptions without_energies(TransientOptions options) {
  options.record_energies = false;
  return options;
}

/// Differentiates outputs instant by instant.
class DerivativeRecorder {
 public:
  DerivativeRecorder(const System& system, const std::vector<Variation>& variations,
                     const TransientOptions& options, Eigen::Index n, std::vector<Transient>& out)
      : system_(system), variations_(variations), options_(without_energies(options)), out_(out) {
    out_.resize(variations.size());
    for (Transient& derivative : out_) Recorder(system, options_, n, derivative);  // makes room
  }

  void record(Eigen::Index k, const State& state, const StateDerivative& derivative, const Loads& loads) {
    for (std::size_t p = 0; p < variations_.size(); ++p) {
      const Variation& varied = variations_[p];
      const auto column = static_cast<Eigen::Index>(p);
      const Transient up = outputs(*varied.plus, moved(system_, state, derivative, column, varied.up), loads);
      const Transient down =
          outputs(*varied.minus, moved(system_, state, derivative, column, varied.down), loads);
      out_[p].time[k] = state.t;
      for (const auto member : columns) {
        if ((out_[p].*member).size() == 0) continue;
        (out_[p].*member).col(k) = ((up.*member).col(0) - (down.*member).col(0)) / varied.spread();
      }
      if (options_.record_rotations) orientations(k, p, up, down);
    }
  }

 private:
  Transient outputs(const System& system, const State& state, const Loads& loads) const {
    Transient at;
    Recorder(system, options_, 1, at).record(0, state, loads);
    return at;
  }

  /// A quaternion and its opposite are one rotation: the difference is taken between neighbours.
  void orientations(Eigen::Index k, std::size_t p, const Transient& up, const Transient& down) {
    for (Eigen::Index i = 0; i + 4 <= up.orientation.rows(); i += 4) {
      const Eigen::Vector4d a = up.orientation.col(0).segment<4>(i),
                            b = down.orientation.col(0).segment<4>(i);
      const double sign = a.dot(b) < 0 ? -1 : 1;
      out_[p].orientation.col(k).segment<4>(i) = (a - sign * b) / variations_[p].spread();
    }
  }

  const System& system_;
  const std::vector<Variation>& variations_;
  TransientOptions options_;
  std::vector<Transient>& out_;
};

}  // namespace

DifferentiatedRun simulate(const System& system, const Equilibrium& equilibrium,
                           const std::vector<PiecewisePolynomial>& drives, const TransientOptions& options,
                           std::vector<Variation> variations, StateDerivative initial,
                           const Progress& progress) {
  DifferentiatedRun result;
  Sensitivities sensitivities(system, solvers::HhtCoefficients::from_alpha(options.alpha),
                              std::move(variations), std::move(initial));
  DerivativeRecorder recorder(system, sensitivities.variations(), options,
                              number_of_steps(system, drives, options) + 1, result.derivatives);
  const Companion companion{
      [&](const State& before, const State& after, const VectorXd& exponent, double h, const Loads& loads) {
        sensitivities.follow(before, after, exponent, h, loads);
      },
      [&](Eigen::Index k, const State& state, const Loads& loads) {
        recorder.record(k, state, sensitivities.derivative(), loads);
      }};
  result.run = simulate(system, equilibrium, drives, options, progress, companion);
  for (Transient& derivative : result.derivatives) derivative.finish(result.run.time.size());
  return result;
}

}  // namespace flexarm::simulation
