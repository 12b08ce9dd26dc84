/// Arms whose links are reduced parts, beside the same arms of beam elements.
#include <doctest/doctest.h>

#include "flexarm/errors.hpp"
#include "flexarm/integrators/hht.hpp"
#include "flexarm/simulation/modal.hpp"
#include "flexarm/simulation/reactions.hpp"
#include "flexarm/simulation/transient.hpp"
#include "parts.hpp"

namespace flexarm::tests::superelement_arm_test {

using namespace flexarm::simulation;
using flexarm::geometry::log3;
using flexarm::geometry::relative;

namespace {

const std::map<std::string, DriveKind> driven = {{"hinge", DriveKind::motor_angle}};

/// The paper's arm with its tube as one part, reduced from 24 beam elements.
flexarm::model::Arm arm_of_one_part(int n_modes) {
  auto arm = paper_arm({.hub_stiffness = 1e5});
  const auto beam = std::get<flexarm::model::BeamLink>(arm.links[0]);
  arm.links[0] = reduced_beam(beam, 24, n_modes);
  arm.joints[0].child = "tube:i1";
  arm.payloads[0] = {.name = "payload", .link = "tube:i2", .mass = 14.1};
  arm.points[0] = {.name = "tip", .link = "tube:i2", .loaded = true};
  return arm;
}

/// The same with the tube as a chain of parts, each one beam element long and without modes.
flexarm::model::Arm arm_of_segments(int segments) {
  auto arm = paper_arm({.hub_stiffness = 1e5});
  auto beam = std::get<flexarm::model::BeamLink>(arm.links[0]);
  const auto segment = beam.end / segments;
  arm.links.clear();
  arm.joints.resize(1);
  for (int k = 0; k < segments; ++k) {
    Structure piece = star_of_beams({-0.5 * segment, 0.5 * segment}, 1, beam);
    for (Vector3d& node : piece.nodes) node += 0.5 * segment;
    const std::string name = std::string("s").append(std::to_string(k));
    arm.links.emplace_back(craig_bampton(name, piece, 2, 0));
    if (k == 0) {
      arm.joints[0].child = name + ":i1";
    } else {
      arm.joints.push_back({.name = std::string("j").append(std::to_string(k)),
                            .type = JointType::fixed,
                            .parent = std::string("s").append(std::to_string(k - 1)) + ":i2",
                            .child = name + ":i1"});
    }
  }
  const std::string end = std::string("s").append(std::to_string(segments - 1)) + ":i2";
  arm.payloads[0] = {.name = "payload", .link = end, .mass = 14.1};
  arm.points[0] = {.name = "tip", .link = end, .loaded = true};
  return arm;
}

/// Tip under gravity, the drive held at q.
Vector3d resting_tip(const flexarm::model::Arm& arm, double q) {
  const System system(arm, driven);
  std::vector<double> values(arm.joints.size(), 0.0);
  values[0] = q;
  return system.point_frame(static_equilibrium(system, values, Loads{}).state, 0).x;
}

std::vector<double> frequencies(const flexarm::model::Arm& arm, double q, int count,
                                const Vector3d& gravity = {0, 0, -9.81}) {
  const System system(arm, driven);
  std::vector<double> values(arm.joints.size(), 0.0);
  values[0] = q;
  return modes(system, static_equilibrium(system, values, Loads{.gravity = gravity}), count).frequency_hz;
}

/// Path of the tip while the drive turns by 1.2 rad in 2 s.
MatrixXd swing(const flexarm::model::Arm& arm) {
  const System system(arm, driven);
  std::vector<double> values(arm.joints.size(), 0.0);
  values[0] = half_pi;
  MatrixXd c(6, 1);
  const double a = -1.2, T = 2;
  c << 6 * a / std::pow(T, 5), -15 * a / std::pow(T, 4), 10 * a / std::pow(T, 3), 0, 0, half_pi;
  std::vector<PiecewisePolynomial> drives(arm.joints.size(), PiecewisePolynomial::constant(0));
  drives[0] = {{0, T}, c};
  const auto rest = static_equilibrium(system, values, Loads{});
  return simulate(system, rest, drives, {.end = 3, .step = 2e-3}, {}).position;
}

}  // namespace

TEST_CASE("A tube reduced to one part sags as the tube") {
  const Vector3d beam = resting_tip(paper_arm({.elements = 24, .hub_stiffness = 1e5}), 0.0);
  const Vector3d part = resting_tip(arm_of_one_part(4), 0.0);
  CHECK(part.z() == near(beam.z(), 1e-4));  // 53 mm
  // Along the arm the arc through the ends misses the shortening by the part c of the deflection that is not
  // an arc: ½ ∫ w'² = 3 c²/5 L for w = c (3 ξ² − 2 ξ³), c = P L³/12 EI + 7 m g L³/(24 · 24 EI) from gravity.
  const double EI = 210e9 * 2.37e-7, L = 3, m = 7850 * 5.82e-4 * L;
  const double c = standard_gravity * L * L * L / EI * (14.1 / 12 + m * (1.0 / 8 - 1.0 / 12));
  CHECK(part.x() - beam.x() == near(0.6 * c * c / L, 0.1));
}

TEST_CASE("A tube of four parts without modes is the tube") {
  const auto beam = paper_arm({.elements = 8, .hub_stiffness = 1e5}), parts = arm_of_segments(4);
  CHECK(error(resting_tip(beam, 0.3), resting_tip(parts, 0.3)) < 1e-6);
  const auto f = frequencies(beam, 0.3, 2), g = frequencies(parts, 0.3, 2);
  for (int k = 0; k < 2; ++k) CHECK(g[k] == near(f[k], 1e-5));  // modes in and across the plane
  CHECK(error(swing(beam), swing(parts)) < 5e-6);
}

TEST_CASE("More modes of a part bring the frequencies of the arm down to the exact ones") {
  const auto exact =
      frequencies(paper_arm({.elements = 24, .hub_stiffness = 1e5}), half_pi, 6, Vector3d::Zero());
  std::vector<double> last(6, std::numeric_limits<double>::infinity());
  for (int n_modes : {0, 2, 4, 8, 16}) {
    const auto f = frequencies(arm_of_one_part(n_modes), half_pi, 6, Vector3d::Zero());
    for (int k = 0; k < 6; ++k) {
      CHECK(f[k] > exact[k] * (1 - 1e-9));
      CHECK(f[k] < last[k] * (1 + 1e-9));
    }
    last = f;
  }
  for (int k = 0; k < 6; ++k) CHECK(last[k] == near(exact[k], 2e-4));
}

TEST_CASE("Gravity's shift of the first mode is in a part, but for its bending between the interfaces") {
  const auto shift = [](const flexarm::model::Arm& arm) {
    return frequencies(arm, half_pi, 1)[0] / frequencies(arm, half_pi, 1, Vector3d::Zero())[0] - 1;
  };
  const double tube = shift(paper_arm({.elements = 24, .hub_stiffness = 1e5}));
  const double one = shift(arm_of_one_part(8)), four = shift(arm_of_segments(4));
  CHECK(four == near(tube, 0.01));
  CHECK(one == near(0.87 * tube, 0.03));  // one part is too long for the tension within it
}

TEST_CASE("One part swings as the tube to 0.4 mm of 45, four to 5 um: tension bends with their length") {
  const auto beam = swing(paper_arm({.elements = 24, .hub_stiffness = 1e5}));
  const double apart = error(beam, swing(arm_of_one_part(4)));
  CHECK(apart > 1e-4);
  CHECK(apart < 4e-4);
}

TEST_CASE("One factorisation serves a part that swings through half a turn") {
  const System system(arm_of_one_part(4), driven);
  const auto rest = static_equilibrium(system, {half_pi}, Loads{.gravity = Vector3d::Zero()});
  const double a = -std::numbers::pi, T = 20;
  MatrixXd c(6, 1);
  c << 6 * a / std::pow(T, 5), -15 * a / std::pow(T, 4), 10 * a / std::pow(T, 3), 0, 0, half_pi;
  const auto run = simulate(system, rest, {{{0, T}, c}}, {.end = T, .step = 5e-3}, {});
  CHECK(run.statistics.factorisations == 1);
}

TEST_CASE("A spun part without loads keeps its momentum and, being stiff, its shape") {
  flexarm::model::Arm arm;
  arm.name = "spun";
  arm.gravity.setZero();
  arm.links = {tripod()};
  arm.joints = {{.name = "hinge", .type = JointType::spherical, .child = "tripod:i1"}};
  const System system(arm, {});
  const Loads weightless{.gravity = Vector3d::Zero()};
  State state = system.rigid_state({0.0});
  const auto& part = system.superelements()[0];
  const Vector6d spin = (Vector6d() << 0, 0, 0, 1, 2, -1.5).finished();
  for (int i = 0; i < part.n_interfaces(); ++i) {
    state.v.segment<6>(6 * part.node(i)) =
        flexarm::geometry::adjoint(relative(state.frames[part.node(i)], state.frames[part.node(0)])) * spin;
  }
  balance(system, weightless, state);
  const auto angular_momentum = [&] {  // about the hinge, in the base's axes
    const VectorXd p = part.mass() * system.velocities(part, state.v);
    Vector6d sum = Vector6d::Zero();
    for (int i = 0; i < part.n_interfaces(); ++i) {
      sum +=
          flexarm::geometry::adjoint(state.frames[part.node(i)].inverse()).transpose() * p.segment<6>(6 * i);
    }
    return Vector3d(sum.tail<3>() - state.frames[part.node(0)].x.cross(Vector3d(sum.head<3>())));
  };
  const Vector3d before = angular_momentum();
  flexarm::integrators::HhtStepper stepper(system, flexarm::integrators::HhtCoefficients::from_alpha(-0.05),
                                           weightless);
  for (int k = 0; k < 500; ++k) {
    stepper.advance(state, 1e-3, [](double, flexarm::integrators::DriveValues&) {});
  }
  CHECK(error(angular_momentum(), before) < 1e-4 * before.norm());
  CHECK(largest(part.deformation(system.configuration(part, state))) < 1e-3);
  CHECK(largest(log3(state.frames[0].R)) > 0.5);
}

TEST_CASE("An arm with parts carries its weight at the base") {
  const System system(tripod_arm(), {{"turn", DriveKind::motor_angle}, {"wrist", DriveKind::motor_angle}});
  const Loads loads{.gravity = {1, 2, -9}};
  const auto rest = static_equilibrium(system, {0.3, 0, -0.4, 0}, loads);
  const Vector3d force = base_wrench(system, rest.state).head<3>();
  CHECK(error(force, system.mass() * loads.gravity) < 1e-8 * 9 * system.mass());
}

TEST_CASE("A place on a part must be one of its interfaces") {
  auto arm = arm_of_one_part(0);
  arm.joints[0].child = "tube";
  CHECK_THROWS_WITH_AS(System(arm, driven), doctest::Contains("there are: i1, i2"),
                       flexarm::InvalidParameter);
  arm.joints[0].child = "tube:i3";
  CHECK_THROWS_WITH_AS(System(arm, driven), doctest::Contains("'tube:i3' must name an interface"),
                       flexarm::InvalidParameter);
}

}  // namespace flexarm::tests::superelement_arm_test
