#include "flexarm/assembly/system.hpp"

#include <doctest/doctest.h>

#include "flexarm/errors.hpp"
#include "parts.hpp"

namespace flexarm::tests::system_test {

using flexarm::InvalidParameter;
using flexarm::assembly::PointLoad;
using flexarm::assembly::TangentFactors;
using flexarm::geometry::exp6;

namespace {

using Drives = std::map<std::string, DriveKind>;

/// A curvature of the column, a force at the tool and a turn of the base, each of the state of a joint.
flexarm::model::Arm arm_with_tables() {
  using flexarm::joints::MonotoneCubic;
  using flexarm::joints::Of;
  flexarm::model::Arm arm = spatial_arm();
  const MonotoneCubic table({-40, -1, 0.5, 40}, {-3, -0.2, 0.3, 5}), line({-100, 100}, {-5, 5});
  const flexarm::model::StateTable curvature{"turn", Of::angle, table, {1, 0, 0}},
      force{"lift", Of::rate, line, {2, -1, 3}}, turn{"slide", Of::motor_angle, table};
  std::get<flexarm::model::BeamLink>(arm.links[0]).curvature = curvature;
  arm.payloads[0].force = force;
  arm.pedestal = flexarm::model::Pedestal{.hinges = {{.axis = {0, 1, 0}, .follows = turn}}};
  return arm;
}

/// Every kind of arm and drive that the assembly distinguishes.
std::vector<System> systems() {
  std::vector<System> all;
  all.emplace_back(two_link_arm(),
                   Drives{{"shoulder", DriveKind::motor_angle}, {"elbow", DriveKind::motor_angle}});
  all.emplace_back(two_link_arm(), Drives{{"shoulder", DriveKind::torque}, {"elbow", DriveKind::free}});
  all.emplace_back(
      spatial_arm(),
      Drives{{"turn", DriveKind::torque}, {"slide", DriveKind::motor_angle}, {"lift", DriveKind::free}});
  all.emplace_back(
      spatial_arm(),
      Drives{{"turn", DriveKind::link_angle}, {"slide", DriveKind::free}, {"lift", DriveKind::locked}});
  flexarm::model::Arm geared = spatial_arm();
  geared.gears = {{"coupling", "turn", "lift", -1.7}};
  all.emplace_back(geared, Drives{{"turn", DriveKind::motor_angle}, {"lift", DriveKind::free}});
  flexarm::model::Arm ball = spatial_arm();
  ball.joints[2].type = JointType::spherical;
  all.emplace_back(ball, Drives{{"turn", DriveKind::free}});
  flexarm::model::Arm rigid = spatial_arm();
  rigid.joints[1].type = JointType::fixed;
  all.emplace_back(rigid, Drives{{"turn", DriveKind::locked}, {"lift", DriveKind::motor_angle}});
  flexarm::model::Arm rippling = spatial_arm();
  rippling.joints[0].drive_train.transmission =
      flexarm::joints::Transmission{.scale = 1.1, .amplitude = 0.02, .multiple = 15, .phase = 0.4};
  rippling.joints[2].drive_train.transmission =
      flexarm::joints::Transmission{.scale = 0.9, .amplitude = 0.03, .multiple = 9};
  all.emplace_back(rippling, Drives{{"turn", DriveKind::torque}, {"lift", DriveKind::free}});
  all.emplace_back(rippling, Drives{{"turn", DriveKind::motor_angle}, {"lift", DriveKind::link_angle}});
  const flexarm::model::Arm tables = arm_with_tables();
  all.emplace_back(tables, Drives{{"turn", DriveKind::torque}, {"slide", DriveKind::free}});
  all.emplace_back(tables, Drives{{"turn", DriveKind::motor_angle}, {"lift", DriveKind::free}});
  all.emplace_back(tripod_arm(), Drives{{"turn", DriveKind::motor_angle}, {"wrist", DriveKind::free}});
  const Drives by_cylinder = {{"boom_pin", DriveKind::free}, {"cylinder_pin", DriveKind::free}};
  all.emplace_back(crane_arm(), by_cylinder);
  all.emplace_back(rigid_crane_arm(), by_cylinder);
  flexarm::model::Arm leaning = crane_arm();
  leaning.closures[0].type = flexarm::joints::ClosureType::universal;
  leaning.closures[0].second_axis = Vector3d::UnitZ();
  all.emplace_back(leaning, by_cylinder);
  return all;
}

Loads some_loads(const System& system) {
  Loads loads{.gravity = {1, -2, -9}};
  for (int p = 0; p < static_cast<int>(system.points().size()); ++p) {
    loads.points.push_back({p, {3, -5, 2}, {1, 0.5, -2}, false});
    loads.points.push_back({p, {-1, 4, 2}, {0.3, 1.5, -1}, true});
  }
  loads.torques = VectorXd::LinSpaced(system.n_scalars(), 1, 2);
  return loads;
}

/// Residual and violation together: the left sides of (1), (2).
VectorXd equations(const System& system, const State& state, const Loads& loads) {
  VectorXd r(system.n_velocities()), phi(system.n_constraints()), both(system.n_unknowns());
  system.residual(state, loads, false, r);
  system.violation(state, phi);
  both << r.head(system.n_free()), phi;
  return both;
}

}  // namespace

TEST_CASE("The tangent is the derivative of equilibrium and constraints by positions and multipliers") {
  unsigned seed = 1;
  for (const System& system : systems()) {
    State state = random_state(system, seed++, 0.15);
    state.v.setZero();  // at rest: the stiffness of moving dampers is left out on purpose
    const Loads loads = some_loads(system);
    const auto f = [&](const VectorXd& dx) {
      State there = state;
      flexarm::integrators::move(system, dx.head(system.n_free()), there);
      there.multipliers += dx.tail(system.n_constraints());
      return equations(system, there, loads);
    };
    const MatrixXd expected = differences(f, system.n_unknowns());
    const MatrixXd S = system.tangent(state, loads, {0, 0, 1});
    CAPTURE(seed);
    const int n = system.n_free(), m = system.n_constraints();
    CHECK(relative_error(S.topRows(n), expected.topRows(n)) < 1e-9);
    CHECK(error(S.bottomRows(m), expected.bottomRows(m)) < 1e-8);
    // The small entries (gravity, joint forces), without the beams' axial stiffness in the scale.
    CHECK(error(S.topRows(n), expected.topRows(n)) < 1e-3);
    CHECK(error(MatrixXd(system.constraint_jacobian(state)), expected.bottomLeftCorner(m, n)) < 1e-8);
  }
}

TEST_CASE("Its damping part is the derivative by velocities, its mass part that by accelerations") {
  unsigned seed = 20;
  for (const System& system : systems()) {
    const State state = random_state(system, seed++);
    const Loads loads = some_loads(system);
    const int n = system.n_free();
    const auto with = [&](VectorXd State::* part) {
      return [&, part](const VectorXd& d) -> VectorXd {
        State there = state;
        (there.*part).head(n) += d;
        return equations(system, there, loads).head(n);
      };
    };
    const MatrixXd C = system.tangent(state, loads, {0, 1, 0}, false);
    const MatrixXd M = system.tangent(state, loads, {1, 0, 0}, false);
    CAPTURE(seed);
    // Quadratic and linear: the formula is exact for any step, and a large one drowns the rounding.
    CHECK(relative_error(C, differences(with(&State::v), n, 10)) < 1e-10);
    CHECK(relative_error(M, differences(with(&State::v_dot), n, 1e4)) < 1e-10);
    CHECK(error(M, M.transpose()) < 1e-15);
  }
}

TEST_CASE("Where tables are held, the stiffness of an arm without other couplings is symmetric") {
  flexarm::model::Arm arm = arm_with_tables();
  arm.joints[1].drive_train.stages = {{ReducerSpring{5000}}};
  const System system(arm,
                      {{"turn", DriveKind::free}, {"slide", DriveKind::free}, {"lift", DriveKind::free}});
  const State state = system.rigid_state({0.1, 0.02, -0.2});
  const Loads loads{.gravity = Vector3d::Zero()};
  const auto unsymmetric = [&](bool hold) {
    const MatrixXd K = system.tangent(state, loads, {0, 0, 1, 1, hold}, false);
    return (K - K.transpose()).cwiseAbs().maxCoeff() / K.cwiseAbs().maxCoeff();
  };
  CHECK(unsymmetric(false) > 1e-3);
  CHECK(unsymmetric(true) < 1e-3 * unsymmetric(false));
}

TEST_CASE(
    "At equilibrium of the free motions the stiffness is symmetric, as the second derivative of an energy") {
  const System system(two_link_arm(), {{"shoulder", DriveKind::motor_angle}});
  State state = system.rigid_state({0.3, 0.2});  // no stress, no weight, no multipliers
  const MatrixXd K = system.tangent(state, Loads{.gravity = Vector3d::Zero()}, {0, 0, 1}, false);
  CHECK(error(K, K.transpose()) < 1e-15 * largest(K));
}

TEST_CASE("Nothing changes in local axes when arm, base and gravity turn together") {
  Random random(40);
  const Frame Q = exp6(random.twist(2, 2));
  flexarm::model::Arm turned_arm = spatial_arm();
  turned_arm.joints[0].origin = Q * turned_arm.joints[0].origin;
  const Drives drives{
      {"turn", DriveKind::torque}, {"slide", DriveKind::motor_angle}, {"lift", DriveKind::free}};
  const System system(spatial_arm(), drives), turned(turned_arm, drives);
  const State state = random_state(system, 41);
  State turned_state = state;
  for (Frame& H : turned_state.frames) H = Q * H;
  const Loads loads = some_loads(system);
  Loads turned_loads = loads;
  turned_loads.gravity = Q.R * loads.gravity;
  for (PointLoad& load : turned_loads.points) {
    if (load.follows) continue;
    load.force = Q.R * load.force;
    load.moment = Q.R * load.moment;
  }
  CHECK(relative_error(equations(turned, turned_state, turned_loads), equations(system, state, loads)) <
        1e-12);
  const MatrixXd S = system.tangent(state, loads, {2, 3, 1}),
                 S_turned = turned.tangent(turned_state, turned_loads, {2, 3, 1});
  CHECK(relative_error(S_turned, S) < 1e-12);
}

TEST_CASE("One pass gives the residual and the violation that two give") {
  unsigned seed = 50;
  for (const System& system : systems()) {
    const State state = random_state(system, seed++, 0.15);
    const Loads loads = some_loads(system);
    VectorXd r(system.n_velocities()), phi(system.n_constraints()), r_alone = r, phi_alone = phi;
    system.evaluate(state, loads, r, phi);
    system.residual(state, loads, true, r_alone);
    system.violation(state, phi_alone);
    CHECK(relative_error(r, r_alone) < 1e-14);
    CHECK(relative_error(phi, phi_alone) < 1e-14);
  }
}

TEST_CASE("A rigid state stands on its constraints, unstrained, at the joint values asked for") {
  for (const System& system : systems()) {
    const std::vector<double> values = {0.4, 0.4 / -1.7, 0.4 / -1.7, 0.4};  // suits the gear too
    const std::vector<double> q(values.begin(), values.begin() + static_cast<long>(system.joints().size()));
    const State state = system.rigid_state(q);
    VectorXd phi(system.n_constraints());
    system.violation(state, phi);
    CHECK(largest(phi) < 1e-14);
    for (const auto& beam : system.beams()) {
      CHECK(largest(beam.deformation(state.frames[beam.node1()], state.frames[beam.node2()])) < 1e-14);
    }
    for (const auto& part : system.superelements()) {
      CHECK(largest(part.deformation(system.configuration(part, state))) < 1e-14);
    }
    for (std::size_t j = 0; j < q.size(); ++j) {
      if (system.joints()[j].theta < 0) continue;
      if (system.in_loop(static_cast<int>(j)) && system.drives()[j] == DriveKind::free) continue;  // follows
      const auto* psi = system.transmission(static_cast<int>(j));
      const bool through = psi != nullptr && system.drives()[j] != DriveKind::link_angle;
      CHECK(state.s[system.joints()[j].theta] == (through ? (*psi)(q[j]).psi : q[j]));
    }
  }
}

TEST_CASE("A two-link arm stands where trigonometry puts it") {
  const System system(two_link_arm(), {});
  const State state = system.rigid_state({0.3, 0.5});
  const Vector3d tip(std::cos(0.3) + 0.8 * std::cos(0.8), 0, -std::sin(0.3) - 0.8 * std::sin(0.8));
  CHECK(error(system.point_frame(state, 0).x, tip) < 1e-14);
}

TEST_CASE("Mass and reach are those of the parts") {
  const System system(spatial_arm(), {});
  const double beams =
      0.03 * 0.02 * 2700 * (Vector3d(0.1, 0.2, 0.9).norm() + Vector3d(0.7, 0.1, -0.1).norm());
  CHECK(system.mass() == near(beams + 2.0 + 1.2, 1e-14));
  CHECK(system.reach() >= Vector3d(0.1, 0.2, 0.9).norm() + Vector3d(0.7, 0.1, -0.1).norm());
  // All nodes falling together: ½ vᵀ M v = ½ m v², less what the scalar coordinates would add.
  State state = system.rigid_state({0, 0, 0});
  VectorXd v = VectorXd::Zero(system.n_free());
  for (int n = 0; n < system.n_nodes(); ++n) {
    v.segment<3>(6 * n) = state.frames[n].R.transpose() * Vector3d(0, 0, 1);
  }
  const MatrixXd M = system.tangent(state, Loads{}, {1, 0, 0}, false);
  CHECK(v.dot(M * v) == near(system.mass(), 1e-13));
}

TEST_CASE("Unknowns are counted as documented") {
  const System driven(two_link_arm(),
                      {{"shoulder", DriveKind::motor_angle}, {"elbow", DriveKind::link_angle}});
  CHECK(driven.n_nodes() == 6);
  CHECK(driven.n_scalars() == 3);       // φ, θ of the shoulder; the elbow's angle alone
  CHECK(driven.n_free() == 6 * 6 + 1);  // θ of the shoulder
  CHECK(driven.n_constraints() == 12);
  const System moved(two_link_arm(), {{"shoulder", DriveKind::torque}, {"elbow", DriveKind::free}});
  CHECK(moved.n_free() == 6 * 6 + 4);
}

TEST_CASE("The velocity of a point is the rate of its position") {
  const System system(spatial_arm(), {{"turn", DriveKind::free}});
  const State state = random_state(system, 50);
  for (int p = 0; p < 2; ++p) {
    const Frame H = system.point_frame(state, p);
    const auto motion = [&](const VectorXd& t) -> VectorXd {
      State there = state;
      flexarm::integrators::move(system, t[0] * state.v.head(system.n_free()), there);
      return flexarm::geometry::log6(relative(H, system.point_frame(there, p)));
    };
    CHECK(error(system.point_velocity(state, p), differences(motion, 1)) < 1e-10);
  }
}

TEST_CASE("What does not fit together is refused by name") {
  CHECK_THROWS_WITH_AS(System(two_link_arm(), {{"wrist", DriveKind::free}}),
                       "there is no joint 'wrist'; there are: shoulder, elbow", InvalidParameter);
  flexarm::model::Arm arm = two_link_arm();
  arm.joints[1].parent = "fore";
  arm.joints[1].child = "fore";
  const System floating(arm, {});
  CHECK_THROWS_WITH_AS(floating.rigid_state({0, 0}), "link 'fore' is not connected to the base by joints",
                       InvalidParameter);
  CHECK_THROWS_WITH_AS(floating.rigid_state({0}), doctest::Contains("one value for each of the 2 joints"),
                       InvalidParameter);
  arm = two_link_arm();
  arm.payloads[0].link = "hand";
  CHECK_THROWS_WITH_AS(System(arm, {}), "there is no link 'hand'", InvalidParameter);
  arm = two_link_arm();
  std::get<flexarm::model::BeamLink>(arm.links[0]).elements = 0;
  CHECK_THROWS_WITH_AS(System(arm, {}), "link 'upper': elements must be at least 1, got 0", InvalidParameter);
  arm = two_link_arm();
  for (auto& joint : arm.joints) joint.drive_train = {};
  arm.gears = {{"pair", "shoulder", "elbow", 2}};
  CHECK_THROWS_WITH_AS(System(arm, {}), doctest::Contains("gear 'pair': input and output are both driven"),
                       InvalidParameter);
}

TEST_CASE("A model with a number that is not finite is refused by the name of its part") {
  const auto message = [](const flexarm::model::Arm& arm) -> std::string {
    try {
      const System system(arm, {});
    } catch (const flexarm::InvalidParameter& error) {
      return error.what();
    }
    return "";
  };
  CHECK(message(paper_arm()).empty());
  for (const double bad : {std::nan(""), HUGE_VAL}) {
    auto arm = paper_arm();
    arm.gravity.z() = bad;
    CHECK(message(arm).find("arm") == 0);
    arm = paper_arm();
    std::get<flexarm::model::BeamLink>(arm.links.front()).material.density = bad;
    CHECK(message(arm).find("link '") == 0);
    arm = paper_arm();
    arm.joints.front().origin.x.x() = bad;
    CHECK(message(arm).find("joint 'hinge'") == 0);
  }
}

TEST_CASE("A joint that neither turns nor slides takes no drive") {
  auto arm = paper_arm();
  for (const auto type : {flexarm::joints::JointType::fixed, flexarm::joints::JointType::spherical}) {
    arm.joints.front().type = type;
    CHECK(System(arm, {}).n_scalars() == 0);
    CHECK_THROWS_WITH_AS(System(arm, {{"hinge", DriveKind::torque}}),
                         "joint 'hinge': only a revolute or prismatic joint can be driven",
                         flexarm::InvalidParameter);
  }
}

}  // namespace flexarm::tests::system_test
