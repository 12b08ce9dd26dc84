#include "flexarm/sensitivity/differentiated_sampled_run.hpp"

#include <doctest/doctest.h>

#include "arms.hpp"
#include "flexarm/errors.hpp"

namespace flexarm::tests::differentiated_sampled_run_test {

using namespace flexarm::sensitivity;
using namespace flexarm::simulation;
namespace model = flexarm::model;

namespace {

constexpr double gain = 4000, damping = 1200, command = half_pi + 0.2;
const TransientOptions options = {.end = 0.24, .step = 2e-3, .tolerance = 1e-14};

/// The paper's arm on a geared motor, its modulus and its payload scaled by 1 + their change.
System driven_by_torque(double modulus, double payload) {
  auto arm = paper_arm({.elements = 2, .hub_stiffness = 1e5, .damping_ratio = 0.01});
  arm.joints[0].drive_train.gear_ratio = 120;
  arm.joints[0].drive_train.rotor_inertia = 1e-3;
  std::get<model::BeamLink>(arm.links[0]).material.youngs_modulus *= 1 + modulus;
  arm.payloads[0].mass *= 1 + payload;
  return {arm, {{"hinge", DriveKind::torque}}};
}

/// Hanging at rest, then τ = k (φ_c − φ) − d φ' every second step; the changes are relative.
Transient controlled(double modulus, double payload, double k) {
  const System system = driven_by_torque(modulus, payload);
  SampledRun run(system, static_equilibrium(system, {half_pi}, Loads{}), {{}}, options);
  while (!run.done()) {
    const double torque = gain * (1 + k) * (command - run.drive_angles()[0]) - damping * run.drive_rates()[0];
    run.advance(VectorXd::Constant(1, torque), 2);
  }
  return run.result();
}

}  // namespace

// Newton's iteration leaves 1e-14/(β h²) of accelerations, and nothing holds the motor against what adds up
// of them: differences of runs take steps far above that, extrapolated to an error of the fourth power.
TEST_CASE("A controlled run is differentiated by its arm and by its gain as differences of whole runs say") {
  constexpr double d = 3e-5;
  const System system = driven_by_torque(0, 0), stiff = driven_by_torque(d, 0),
               soft = driven_by_torque(-d, 0), heavy = driven_by_torque(0, d),
               light = driven_by_torque(0, -d);
  const std::vector<Variation> variations = {
      {&stiff, &soft, d, -d, {}, {}}, {&heavy, &light, d, -d, {}, {}}, {&system, &system, d, -d, {}, {}}};
  const auto rest = static_equilibrium(system, {half_pi}, Loads{});
  DifferentiatedSampledRun run(system, rest, {{}}, options, variations,
                               static_derivative(system, rest, variations));
  while (!run.run().done()) {
    const double error = command - run.run().drive_angles()[0];
    Slopes slopes = -gain * run.drive_angle_slopes() - damping * run.drive_rate_slopes();
    slopes(0, 2) += gain * error;
    run.advance(VectorXd::Constant(1, gain * error - damping * run.run().drive_rates()[0]), slopes, 2);
  }
  const DifferentiatedRun found = run.result();
  const Transient::Matrix Transient::* const columns[] = {&Transient::position, &Transient::drive_angle,
                                                          &Transient::motor_torque};
  for (Eigen::Index p = 0; p < 3; ++p) {
    const auto at = [&](double x) { return controlled(p == 0 ? x : 0, p == 1 ? x : 0, p == 2 ? x : 0); };
    const auto slopes = [&](const auto column) {
      const auto difference = [&](double h) -> MatrixXd {
        return (at(h).*column - at(-h).*column) / (2 * h);
      };
      return MatrixXd((4 * difference(4e-3) - difference(8e-3)) / 3);
    };
    for (const auto column : columns) {
      const MatrixXd expected = slopes(column);
      MatrixXd derivative(expected.rows(), expected.cols());
      for (Eigen::Index row = 0; row < expected.rows(); ++row) {
        derivative.row(row) = (found.derivatives.*column).row(3 * row + p);
      }
      CAPTURE(p);
      CHECK(largest(expected) > 0);
      CHECK(largest(derivative - expected) < 1e-6 * largest(expected));
    }
  }
  CHECK(largest(run.point_position_slopes(0).col(1) -
                found.derivatives.position.col(found.run.time.size() - 1)(Eigen::seqN(1, 3, 3))) == 0);
}

TEST_CASE("Derivatives of torques of another number of joints or parameters are refused") {
  const System system = driven_by_torque(0, 0);
  const std::vector<Variation> variations = {{&system, &system, 1e-3, -1e-3, {}, {}}};
  const auto rest = static_equilibrium(system, {half_pi}, Loads{});
  DifferentiatedSampledRun run(system, rest, {{}}, options, variations,
                               static_derivative(system, rest, variations));
  CHECK_THROWS_WITH_AS(run.advance(VectorXd::Zero(1), Slopes::Zero(1, 2), 1),
                       doctest::Contains("for 1 joints and 1 parameters are needed, got 1 by 2"),
                       flexarm::InvalidParameter);
}

}  // namespace flexarm::tests::differentiated_sampled_run_test
