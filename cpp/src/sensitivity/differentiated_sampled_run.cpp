#include "flexarm/sensitivity/differentiated_sampled_run.hpp"

#include "flexarm/errors.hpp"
#include "flexarm/simulation/consistent_start.hpp"

namespace flexarm::sensitivity {
namespace {

using namespace simulation;

/// What readings of the arm are taken from is recorded, whatever the caller asks for.
TransientOptions readable(TransientOptions options) {
  options.record_points = options.record_joints = true;
  return options;
}

std::vector<VariedInSpace<3>> in_space(const std::vector<Variation>& variations) {
  std::vector<VariedInSpace<3>> varied;
  for (const Variation& p : variations) varied.push_back({p, {}, {}});
  return varied;
}

}  // namespace

DifferentiatedSampledRun::DifferentiatedSampledRun(const System& system, const Equilibrium& equilibrium,
                                                   std::vector<PiecewisePolynomial> drives,
                                                   const TransientOptions& options,
                                                   std::vector<Variation> variations, StateDerivative initial)
    : system_(system),
      run_(system, equilibrium, drives, readable(options)),
      sensitivities_(system, integrators::HhtCoefficients::from_alpha(options.alpha), variations,
                     std::move(initial)),
      recorder_(system, {}, in_space(variations), readable(options),
                number_of_steps(system.joints().size(), drives, options) + 1, columns_),
      torques_(Slopes::Zero(system.n_scalars(), static_cast<Eigen::Index>(variations.size()))) {
  run_.observe({[this](const State& before, const State& after, const VectorXd& exponent, double h,
                       const Loads& loads) { sensitivities_.follow(before, after, exponent, h, loads); },
                [this](Eigen::Index k, const State& state, const Loads& loads) {
                  recorder_.record(k, state, sensitivities_.derivative(), loads);
                  k_ = k;
                }});
}

void DifferentiatedSampledRun::advance(const VectorXd& motor_torque, const Slopes& torque_slopes,
                                       int n_steps) {
  const auto n_joints = static_cast<Eigen::Index>(system_.joints().size());
  if (torque_slopes.rows() != n_joints || torque_slopes.cols() != torques_.cols()) {
    throw InvalidParameter("derivatives of motor torques for " + std::to_string(n_joints) + " joints and " +
                           std::to_string(torques_.cols()) + " parameters are needed, got " +
                           std::to_string(torque_slopes.rows()) + " by " +
                           std::to_string(torque_slopes.cols()));
  }
  for (Eigen::Index j = 0; j < n_joints; ++j) {
    const auto k = static_cast<std::size_t>(j);
    if (system_.drives()[k] != assembly::DriveKind::torque) continue;
    torques_.row(system_.joints()[k].phi) = torque_slopes.row(j);
  }
  sensitivities_.hold(torques_);
  if (k_ == 0) {
    const Equilibrium& start = run_.let_go(motor_torque);
    sensitivities_.go_on_from(consistent_start(system_, start, run_.time(), sensitivities_.variations(),
                                               sensitivities_.derivative(), torques_));
    recorder_.record(0, run_.state(), sensitivities_.derivative(), start.loads);
  }
  run_.advance(motor_torque, n_steps);
}

Slopes DifferentiatedSampledRun::now(const Transient::Matrix& columns, Eigen::Index first,
                                     Eigen::Index rows) const {
  const Eigen::Index m = torques_.cols();
  return Eigen::Map<const Slopes>(columns.col(k_).data() + first * m, rows, m);
}

Slopes DifferentiatedSampledRun::of_joints(const Transient::Matrix& columns) const {
  return now(columns, 0, static_cast<Eigen::Index>(system_.joints().size()));
}

DifferentiatedRun DifferentiatedSampledRun::result() const {
  DifferentiatedRun both{run_.result(), columns_};
  both.derivatives.finish(k_ + 1);
  return both;
}

}  // namespace flexarm::sensitivity
