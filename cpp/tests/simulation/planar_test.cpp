#include "flexarm/assembly/planar_system.hpp"

#include <doctest/doctest.h>

#include "arms.hpp"
#include "flexarm/simulation/transient.hpp"
#include "parts.hpp"

namespace flexarm::tests::planar_test {

using namespace flexarm;
using namespace flexarm::simulation;
using assembly::PlanarSystem;

namespace {

/// A swing of every joint that ends at rest.
PiecewisePolynomial swing(double angle) {
  return {{0, 0.4},
          (Eigen::MatrixXd(6, 1) << angle * 6 / 0.01024, -angle * 15 / 0.0256, angle * 10 / 0.064, 0, 0, 0.2)
              .finished()};
}

struct Runs {
  Transient plane, space;
};

/// The same motion in the plane and in space.
Runs both(const model::Arm& arm, std::map<std::string, DriveKind> drives, const Loads& loads = {},
          double step = 4e-3, double tolerance = 1e-10) {
  const System system(arm, drives);
  const std::vector<double> start(arm.joints.size(), 0.2);
  const Equilibrium rest = static_equilibrium(system, start, loads);
  std::vector<PiecewisePolynomial> motion;
  for (const auto& joint : arm.joints) {
    motion.push_back(joint.type == JointType::prismatic ? swing(0.1) : swing(0.8));
  }
  TransientOptions options;
  options.end = 0.6;
  options.step = step;
  options.tolerance = tolerance;
  options.record_rotations = options.record_energies = options.record_forces = true;
  options.dimension = Dimension::plane;
  Runs runs;
  runs.plane = simulate(system, rest, motion, options);
  options.dimension = Dimension::space;
  runs.space = simulate(system, rest, motion, options);
  return runs;
}

/// Both runs stop iterating at 1e-10 of the reach, each with its own last increment, and forces are some
/// 1e5 N of stiffness times that: eight digits of the largest value of a column.
void check_same(const Runs& runs, double tolerance = 2e-8) {
  const auto same = [&](const char* what, const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    CAPTURE(what);
    REQUIRE(a.rows() == b.rows());
    CHECK((a - b).cwiseAbs().maxCoeff() <= tolerance * std::max(1e-3, b.cwiseAbs().maxCoeff()));
  };
  const Transient &p = runs.plane, &s = runs.space;
  CHECK(p.dimension == 2);
  CHECK(s.dimension == 3);
  same("position", p.position, s.position);
  same("velocity", p.velocity, s.velocity);
  same("orientation", p.orientation, s.orientation);
  same("angular rate", p.angular_rate, s.angular_rate);
  same("joint angle", p.joint_angle, s.joint_angle);
  same("drive angle", p.drive_angle, s.drive_angle);
  same("joint torque", p.joint_torque, s.joint_torque);
  same("motor torque", p.motor_torque, s.motor_torque);
  same("kinetic", p.kinetic, s.kinetic);
  same("elastic", p.elastic, s.elastic);
  same("gravity", p.gravity, s.gravity);
  same("damped", p.damped, s.damped);
  same("work", p.work, s.work);
  same("section forces", p.section_forces, s.section_forces);
  same("base wrench", p.base_wrench, s.base_wrench);
  same("final velocity", p.final_state.v, s.final_state.v);
  same("final multipliers", p.final_state.multipliers, s.final_state.multipliers);
  same("final coordinates", p.final_state.s, s.final_state.s);
  for (std::size_t k = 0; k < s.final_state.frames.size(); ++k) {
    CAPTURE(k);
    same("final place", p.final_state.frames[k].x, s.final_state.frames[k].x);
    same("final turn", p.final_state.frames[k].R, s.final_state.frames[k].R);
  }
}

const std::map<std::string, DriveKind> hinge_driven = {{"hinge", DriveKind::motor_angle}};
const std::map<std::string, DriveKind> both_driven = {{"shoulder", DriveKind::motor_angle},
                                                      {"elbow", DriveKind::motor_angle}};

/// Two links whose sections are square to the plane.
model::Arm flat_two_link_arm() {
  model::Arm arm = two_link_arm();
  for (auto& link : arm.links) std::get<model::BeamLink>(link).up = Vector3d::UnitZ();
  return arm;
}

/// One joint is driven, those of the loop follow.
std::map<std::string, DriveKind> driven_by(const std::string& name, const model::Arm& arm) {
  std::map<std::string, DriveKind> drives;
  for (const auto& joint : arm.joints) {
    if (joint.type != JointType::fixed) drives[joint.name] = DriveKind::free;
  }
  drives[name] = DriveKind::motor_angle;
  return drives;
}

/// Of an arm with a loop, whose forces take up more of what an iteration leaves.
Transient check_same_in_loop(const model::Arm& arm, const std::string& driven) {
  const Runs runs = both(arm, driven_by(driven, arm), {}, 4e-3, 1e-13);
  check_same(runs, 1e-6);
  return runs.plane;
}

/// A crane whose loop lies in the plane, and its boom's section square to it.
model::Arm flat_crane_arm(bool rigid) {
  model::Arm arm = rigid ? rigid_crane_arm() : crane_arm();
  if (auto* boom = std::get_if<model::BeamLink>(&arm.links[0])) boom->up = Vector3d::UnitZ();
  if (auto* boom = std::get_if<model::RigidLink>(&arm.links[0])) boom->com.y() = 0;
  for (auto& joint : arm.joints) joint.drive_train.bearing = {joints::ViscousFriction{2.0}};
  return arm;
}

doctest::String obstacle(const model::Arm& arm, const Loads& loads = {},
                         std::map<std::string, DriveKind> drives = {}) {
  const System system(arm, drives);
  const State state = system.rigid_state(std::vector<double>(arm.joints.size(), 0.0));
  const auto attempt = PlanarSystem::about(system, state, loads);
  CHECK(!attempt.system);
  return attempt.obstacle.c_str();
}

}  // namespace

TEST_CASE("Curvatures, forces and a turning base by tables move in the plane as they do in space") {
  using joints::MonotoneCubic, joints::Of;
  const auto table = [](const std::string& joint, Of of, double scale, const Vector3d& direction) {
    return model::StateTable{joint, of, MonotoneCubic({-1, 0.1, 0.6, 1.5}, {0.0, scale, -0.5 * scale, scale}),
                             direction};
  };
  model::Arm arm = flat_two_link_arm();
  auto& upper = std::get<model::BeamLink>(arm.links[0]);
  upper.curvature = table("shoulder", Of::angle, 5e-3, Vector3d::UnitZ());
  arm.payloads[0].force = table("elbow", Of::rate, 4, {1, 0, 0.5});
  arm.pedestal = model::Pedestal{
      .hinges = {{.axis = Vector3d::UnitY(), .follows = table("shoulder", Of::motor_angle, 2e-3, {})}},
      .axis = Vector3d::UnitY()};
  check_same(both(arm, both_driven), 1e-7);

  const auto obstacle = [&] {
    const System system(arm, both_driven);
    const Loads loads;
    return PlanarSystem::about(system, static_equilibrium(system, {0.2, 0.2}, loads).state, loads).obstacle;
  };
  CHECK(obstacle() == "");
  upper.curvature->direction = Vector3d::UnitY();
  CHECK(obstacle() == "the tabulated curvature of link 'upper' bends it out of the plane");
  upper.curvature.reset();
  arm.payloads[0].force->direction = Vector3d::UnitY();
  CHECK(obstacle() == "the tabulated force on link 'fore' pulls out of the plane");
}

TEST_CASE("The paper's arm moves in its plane as it does in space") {
  check_same(both(paper_arm({.hub_stiffness = 1e5, .damping_ratio = 0.01}), hinge_driven));
}

TEST_CASE(
    "Two damped links with gears, springs and a payload beside the axis move alike in plane and space") {
  model::Arm arm = flat_two_link_arm();
  arm.payloads[0].inertia = Vector3d(0.01, 0.02, 0.03).asDiagonal();
  arm.payloads[0].offset = {0.05, 0, -0.08};
  arm.points.push_back({.name = "middle", .link = "fore", .position = {0.3, 0, 0}});
  check_same(both(arm, both_driven));
}

TEST_CASE("Friction that sticks and slips is the same in plane and space") {
  model::Arm arm = flat_two_link_arm();
  arm.joints[0].drive_train.bearing = {joints::DahlFriction{2.0, 1e-4}};
  check_same(both(arm, both_driven), 1e-6);  // a law of width 1e-4 rad magnifies what iterations leave
}

TEST_CASE("A slide within the plane and a motor's torque keep the motion in it") {
  model::Arm arm = flat_two_link_arm();
  arm.joints[1].type = JointType::prismatic;
  arm.joints[1].axis = {1, 0, 0.5};
  check_same(both(arm, {{"shoulder", DriveKind::torque}, {"elbow", DriveKind::motor_angle}}), 1e-7);
}

TEST_CASE("A planar arm may lie anywhere in space, its base beside the origin") {
  model::Arm arm = flat_two_link_arm();
  const Matrix3d R = geometry::exp3({0.4, -0.7, 1.1});
  arm.joints[0].origin = {R, Vector3d(0.3, -0.2, 0.5)};
  Loads loads;
  loads.gravity = R * Vector3d(0, 0, -9.81);
  loads.points = {{.point = 0, .force = R * Vector3d(3, 0, -5), .moment = R * Vector3d(0, 2, 0)},
                  {.point = 0, .force = {1, 0, 4}, .follows = true}};
  check_same(both(arm, both_driven, loads));
}

TEST_CASE("A bow that grows and a base that shakes, both in the plane, leave the motion in it") {
  model::Arm arm = flat_two_link_arm();
  std::get<model::BeamLink>(arm.links[0]).bow = {0, 0, 0.02};
  std::get<model::BeamLink>(arm.links[0]).bow_time = 0.3;
  arm.pedestal = model::Pedestal{.hinges = {{.axis = Vector3d::UnitY(), .stiffness = 2e4, .damping = 10}},
                                 .axis = Vector3d::UnitY(),
                                 .amplitude = 20,
                                 .frequency = 3};
  check_same(both(arm, both_driven));
}

TEST_CASE("A reduced tube, whose modes of equal frequency lie in any plane, moves in one with half of them") {
  auto arm = paper_arm({.hub_stiffness = 1e5});
  const auto beam = std::get<model::BeamLink>(arm.links[0]);
  auto part = reduced_beam(beam, 8, 8);  // three pairs of bending, twist, stretch
  part.damping = 1e-4 * part.stiffness;
  arm.links[0] = part;
  arm.joints[0].child = "tube:i1";
  arm.payloads[0] = {.name = "payload", .link = "tube:i2", .mass = 14.1};
  arm.points[0] = {.name = "tip", .link = "tube:i2", .loaded = true};
  check_same(both(arm, hinge_driven), 1e-7);

  const System system(arm, hinge_driven);
  const auto attempt = PlanarSystem::about(system, system.rigid_state({0.2}), {});
  REQUIRE(attempt.system);
  CHECK(attempt.system->superelements()[0].n_modes() < 5);
  auto skew_part = part;
  skew_part.mass(1, 5) += 1e-6 * skew_part.mass(1, 1);
  skew_part.mass(2, 5) += 1e-6 * skew_part.mass(1, 1);
  skew_part.mass(5, 2) = skew_part.mass(2, 5);
  skew_part.mass(5, 1) = skew_part.mass(1, 5);
  arm.links[0] = skew_part;
  CHECK(obstacle(arm, {}, hinge_driven) == doctest::Contains("link 'tube' is not symmetric to the plane"));
}

TEST_CASE("A flat loop, flexible or rigid, moves in its plane as in space, also where a pin gives") {
  for (const bool rigid : {false, true}) {
    CAPTURE(rigid);
    auto arm = flat_crane_arm(rigid);
    check_same_in_loop(arm, "piston");
    arm.closures[0].mount = {{.axis = Vector3d::UnitX(), .stiffness = 1e6, .type = JointType::prismatic},
                             {.axis = Vector3d::UnitZ(), .stiffness = 2e6, .type = JointType::prismatic}};
    arm.closures[0].bearing = {joints::ViscousFriction{5.0}};
    check_same_in_loop(arm, "piston");
  }
}

TEST_CASE("Every kind of closure moves in a plane as in space") {
  using joints::ClosureType;
  auto arm = flat_crane_arm(true);
  for (const auto type : {ClosureType::spherical, ClosureType::universal, ClosureType::cylindrical,
                          ClosureType::point_on_line}) {  // all of them pins here
    CAPTURE(static_cast<int>(type));
    arm.closures[0].type = type;
    arm.closures[0].second_axis = Vector3d::UnitZ();
    check_same_in_loop(arm, "piston");
  }
  arm.links.push_back(model::RigidLink{"eye", 0.5, {0.05, 0, 0}, 1e-3 * Matrix3d::Identity()});
  arm.joints.push_back({.name = "eye_pin",
                        .parent = "boom",
                        .child = "eye",
                        .origin = Frame::translation({1.2, 0, -0.1}),
                        .axis = Vector3d::UnitY()});
  arm.closures[0].b = "eye";
  arm.closures[0].b_origin = {};
  arm.closures[0].type = ClosureType::fixed;
  check_same_in_loop(arm, "piston");
  arm.joints[2].type = JointType::fixed;  // the eye slides along the rod
  arm.closures[0].axis = Vector3d::UnitZ();
  for (const auto type : {ClosureType::prismatic, ClosureType::cylindrical}) {
    CAPTURE(static_cast<int>(type));
    arm.closures[0].type = type;
    check_same_in_loop(arm, "boom_pin");
  }
  arm.closures[0].type = ClosureType::point_on_line;
  arm.joints[3].type = JointType::fixed;
  check_same_in_loop(arm, "boom_pin");
}

TEST_CASE("A loop that is closed on the base moves in a plane as in space, its base wrench as well") {
  auto arm = flat_crane_arm(true);
  arm.joints[1] = {.name = "cylinder_pin",
                   .parent = "boom",
                   .child = "cylinder",
                   .origin = Frame::translation({1.2, 0, -0.1}),
                   .axis = -Vector3d::UnitY()};
  auto& eye = arm.closures[0];
  eye.b = "base";
  eye.b_origin = Frame::translation({0.3, 0.5, 0.2});
  arm.joints[0].origin = Frame::translation({0, 0.5, 1});  // all beside the plane through the base's origin
  arm.assembly = {{"boom_pin", -0.05}, {"cylinder_pin", 2.24}, {"piston", 0.2}};
  const Transient run = check_same_in_loop(arm, "piston");
  std::swap(eye.a, eye.b);
  std::swap(eye.a_origin, eye.b_origin);
  const Transient swapped = both(arm, driven_by("piston", arm), {}, 4e-3, 1e-13).plane;
  CHECK(relative_error(swapped.position, run.position) < 1e-9);
  CHECK(relative_error(swapped.joint_torque, run.joint_torque) < 1e-6);
  CHECK(relative_error(swapped.base_wrench, run.base_wrench) < 1e-6);
}

TEST_CASE("Closures that leave the plane are named, and conditions repeated within it") {
  auto arm = flat_crane_arm(true);
  arm.closures[0].type = joints::ClosureType::point_on_line;
  arm.closures[0].axis = {0, 1, 1};
  CHECK(obstacle(arm, {}, driven_by("piston", arm)) ==
        doctest::Contains("closure 'rod_eye' ties what lies across"));
  arm = flat_crane_arm(true);
  arm.closures[0].a_origin.x.y() = arm.closures[0].b_origin.x.y() = 0.1;
  CHECK(obstacle(arm, {}, driven_by("piston", arm)) ==
        doctest::Contains("closure 'rod_eye' stands out of the plane"));
  arm = flat_crane_arm(true);
  arm.closures.push_back(arm.closures[0]);
  arm.closures[1].name = "second eye";
  CHECK(obstacle(arm, {}, driven_by("piston", arm)) ==
        doctest::Contains("repeat conditions within the plane"));
}

TEST_CASE("What leaves the plane is named") {
  const model::Arm flat = flat_two_link_arm();
  CHECK(PlanarSystem::about(System(flat, {}), System(flat, {}).rigid_state({0.2, 0.2}), {}).system);

  Loads sideways;
  sideways.gravity = {0, 1, -9.81};
  CHECK(obstacle(flat, sideways) == doctest::Contains("gravity"));

  Loads pushed;
  pushed.points = {{.point = 0, .force = {0, 1, 0}}};
  CHECK(obstacle(flat, pushed) == doctest::Contains("load at point 'tip'"));
  pushed.points = {{.point = 0, .moment = {1, 0, 0}}};
  CHECK(obstacle(flat, pushed) == doctest::Contains("load at point 'tip'"));

  CHECK(obstacle(two_link_arm()) == doctest::Contains("section of link 'upper'"));

  model::Arm arm = flat;
  arm.joints[1].axis = Vector3d::UnitZ();
  CHECK(obstacle(arm) == doctest::Contains("joint 'elbow' moves out of the plane"));
  arm = flat;
  arm.joints[1].type = JointType::prismatic;
  arm.joints[1].axis = Vector3d::UnitY();
  CHECK(obstacle(arm) == doctest::Contains("joint 'elbow' moves out of the plane"));
  arm = flat;
  arm.joints[1].origin = Frame::translation({0, 0.1, 0});
  CHECK(obstacle(arm) == doctest::Contains("joint 'elbow' stands out of the plane"));
  arm = flat;
  arm.payloads[0].offset = {0, 0.05, 0};
  CHECK(obstacle(arm) == doctest::Contains("mass on link 'fore'"));
  arm = flat;
  arm.payloads[0].inertia << 0.02, 0, 0, 0, 0.02, 0.005, 0, 0.005, 0.02;
  CHECK(obstacle(arm) == doctest::Contains("mass on link 'fore'"));
  arm = flat;
  std::get<model::BeamLink>(arm.links[1]).bow = {0, 0.01, 0};
  CHECK(obstacle(arm) == doctest::Contains("bowed out of the plane"));
  arm = flat;
  std::get<model::BeamLink>(arm.links[1]).end = {0.8, 0.1, 0};
  arm.payloads.clear();
  CHECK(obstacle(arm) == doctest::Contains("link 'fore' points out of the plane"));
}

TEST_CASE("A plane asked for where there is none is refused, and left alone the run is made in space") {
  const model::Arm arm = two_link_arm();
  const System system(arm, both_driven);
  const Equilibrium rest = static_equilibrium(system, {0.2, 0.2}, {});
  TransientOptions options;
  options.end = 0.01;
  CHECK(simulate(system, rest, {{}, {}}, options).dimension == 3);
  options.dimension = Dimension::plane;
  CHECK_THROWS_WITH_AS(simulate(system, rest, {{}, {}}, options),
                       doctest::Contains("does not move in a plane"), InvalidParameter);
}

}  // namespace flexarm::tests::planar_test
