#include "flexarm/integrators/woodbury_update.hpp"

#include <doctest/doctest.h>

#include "arms.hpp"
#include "flexarm/assembly/iteration_matrix.hpp"
#include "flexarm/assembly/planar_system.hpp"
#include "flexarm/integrators/hht.hpp"

namespace flexarm::tests::woodbury_update_test {

using flexarm::assembly::IterationMatrixIn;
using flexarm::assembly::LoadsIn;
using flexarm::assembly::StateIn;
using flexarm::assembly::SystemIn;
using flexarm::assembly::TangentFactors;
using flexarm::integrators::DriveValues;
using flexarm::integrators::HhtCoefficients;
using flexarm::integrators::HhtStepper;
using flexarm::integrators::WoodburyUpdateIn;
using flexarm::linear_solvers::SparseFactor;

namespace {

const TangentFactors factors{1e6, 1e3, 1, 1e6};

/// Chords of all laws over a correction x from a state at rest: as tangents they make the same forces.
template <int D>
VectorXd chords(const SystemIn<D>& system, const StateIn<D>& state, const VectorXd& x) {
  VectorXd found = system.law_tangents(state, factors, true);
  for (std::size_t k = 0; k < system.laws().size(); ++k) {
    const auto& law = system.laws()[k];
    const auto entry = [&](int s) {
      return s >= 0 && system.is_free(s) ? x[system.scalar_offset() + s] : 0.0;
    };
    const double w = entry(law.plus) - entry(law.minus), at = system.deflection(law, state.s);
    if (w == 0) continue;
    const auto force = [&](double further) {
      return flexarm::joints::respond(law.law, at + further, factors.damping * further, state.laws[k]).force;
    };
    found[static_cast<Eigen::Index>(k)] = (force(w) - force(0)) / w;
  }
  return found;
}

/// Undeformed and at rest nothing but joints and laws changes S with the pose. Relative difference of S⁻¹ b
/// from the factors of one pose, corrected, and from those of the other with the chords of the laws; and
/// without correction.
template <int D>
std::pair<double, double> compare(const SystemIn<D>& system, const StateIn<D>& then, const StateIn<D>& now) {
  const LoadsIn<D> weightless{.gravity = flexarm::geometry::Point<D>::Zero()};
  IterationMatrixIn<D> matrix(system);
  SparseFactor kept, present;
  const VectorXd laws = system.law_tangents(then, factors, true);
  REQUIRE(kept.factor(*matrix.assemble(then, weightless, factors, laws)));
  WoodburyUpdateIn<D> update(system, {system, false});
  update.keep(then, factors, laws, kept);

  const VectorXd b = Random(3).vector(system.n_unknowns());
  VectorXd x = b, exact = b;
  kept.solve(x);
  const VectorXd uncorrected = x;
  update.correct(now, x);
  REQUIRE(present.factor(*matrix.assemble(now, weightless, factors, chords(system, now, x))));
  present.solve(exact);
  VectorXd again = uncorrected;
  update.correct(now, again, true);
  CHECK(again == x);
  return {relative_error(x, exact), relative_error(uncorrected, exact)};
}

}  // namespace

TEST_CASE("Kept factors, corrected, solve as new ones after hinges and slides have moved") {
  const System system(spatial_arm(), {{"turn", DriveKind::motor_angle}, {"lift", DriveKind::free}});
  const std::vector<double> rest(system.joints().size(), 0.0);
  std::vector<double> moved;
  for (std::size_t k = 0; k < rest.size(); ++k) moved.push_back(0.9 - 0.3 * static_cast<double>(k));
  const auto [corrected, kept] = compare<3>(system, system.rigid_state(rest), system.rigid_state(moved));
  CHECK(kept > 0.01);
  CHECK(corrected < 1e-9);
}

TEST_CASE("So they do in a plane, and with laws whose tangents change") {
  flexarm::model::Arm arm = two_link_arm();
  for (auto& link : arm.links) std::get<flexarm::model::BeamLink>(link).up = Vector3d::UnitZ();
  arm.joints[1].drive_train.stages[0] = {ReducerSpring{500, 0, 1e5}};
  const System system(arm, {{"shoulder", DriveKind::motor_angle}, {"elbow", DriveKind::motor_angle}});
  const Loads weightless{.gravity = Vector3d::Zero()};
  const auto plane =
      flexarm::assembly::PlanarSystem::about(system, system.rigid_state({0, 0}), weightless).system;
  REQUIRE(plane);
  State then = system.rigid_state({0.2, 0.1}), now = system.rigid_state({0.4, 1.7});
  now.s[system.joints()[1].phi] -= 0.3;
  const auto [corrected, kept] = compare<2>(*plane, plane->part(then), plane->part(now));
  CHECK(kept > 0.01);
  CHECK(corrected < 1e-9);
}

TEST_CASE("One joint alone, which has a shorter way, in space and in a plane") {
  flexarm::model::Arm arm = two_link_arm();
  for (auto& link : arm.links) std::get<flexarm::model::BeamLink>(link).up = Vector3d::UnitZ();
  const auto check = [](const std::pair<double, double>& errors) {
    const auto [corrected, kept] = errors;
    CHECK(kept > 0.01);
    CHECK(corrected < 1e-9);
  };
  for (const JointType type : {JointType::revolute, JointType::prismatic}) {
    CAPTURE(static_cast<int>(type));
    arm.joints[1].type = type;
    if (type == JointType::prismatic) arm.joints[1].axis = {1, 0, 0.5};  // within the plane
    const System system(arm, {{"shoulder", DriveKind::motor_angle}, {"elbow", DriveKind::free}});
    const State then = system.rigid_state({0.2, 0.1}), now = system.rigid_state({0.4, 1.7});
    check(compare<3>(system, then, now));
    const Loads weightless{.gravity = Vector3d::Zero()};
    const auto plane = flexarm::assembly::PlanarSystem::about(system, then, weightless).system;
    REQUIRE(plane);
    check(compare<2>(*plane, plane->part(then), plane->part(now)));
  }
}

TEST_CASE("In a plane the pin that closes a loop is followed, whichever of its sides is on the ground") {
  for (const bool swapped : {false, true}) {
    for (const bool grounded : {false, true}) {
      CAPTURE(swapped);
      CAPTURE(grounded);
      auto arm = rigid_crane_arm();
      std::get<flexarm::model::RigidLink>(arm.links[0]).com.y() = 0;
      auto& eye = arm.closures[0];
      if (grounded) {  // the rod stands on its eye, which the cylinder's pin closes to the base
        arm.joints[1] = {.name = "cylinder_pin",
                         .parent = "boom",
                         .child = "cylinder",
                         .origin = Frame::translation({1.2, 0, -0.1}),
                         .axis = -Vector3d::UnitY()};
        eye.b = "base";
        eye.b_origin = Frame::translation({0.3, 0, 0.2});
      }
      if (swapped) {
        std::swap(eye.a, eye.b);
        std::swap(eye.a_origin, eye.b_origin);
      }
      const System system(arm, {{"boom_pin", DriveKind::free}, {"cylinder_pin", DriveKind::free}});
      const State then = system.rigid_state({0, 0, 0.1}), now = system.rigid_state({0, 0, 0.7});
      const Loads weightless{.gravity = Vector3d::Zero()};
      const auto plane = flexarm::assembly::PlanarSystem::about(system, then, weightless).system;
      REQUIRE(plane);
      CHECK(WoodburyUpdateIn<2>(*plane, {*plane, false}).follows_constraints());
      const auto [corrected, kept] = compare<2>(*plane, plane->part(then), plane->part(now));
      CHECK(kept > 0.01);
      CHECK(corrected < 1e-9);
    }
  }
}

TEST_CASE("A large correction follows a law beyond its tangent, whatever else has moved") {
  for (int laws : {1, 2, 3}) {
    CAPTURE(laws);
    flexarm::model::Arm arm = spatial_arm();
    const ReducerSpring loose{.stiffness = 5000, .damping = 4, .gap = 0.02};
    for (int k = 0; k < laws; ++k) arm.joints[k].drive_train.stages = {{loose}};
    const System system(arm, {{"turn", DriveKind::motor_angle}, {"lift", DriveKind::motor_angle}});
    const std::vector<double> rest(system.joints().size(), 0.0), turned(system.joints().size(), 0.5);
    const State then = system.rigid_state(rest), now = system.rigid_state(turned);
    const Loads weightless{.gravity = Vector3d::Zero()};
    IterationMatrixIn<3> matrix(system);
    SparseFactor kept;
    const VectorXd tangents = system.law_tangents(then, factors, true);
    REQUIRE(kept.factor(*matrix.assemble(then, weightless, factors, tangents)));
    WoodburyUpdateIn<3> update(system, {system, false});
    update.keep(then, factors, tangents, kept);
    const VectorXd b = 1e5 * Random(5).vector(system.n_unknowns());
    VectorXd x = b;
    kept.solve(x);
    update.correct(now, x);

    const VectorXd along = chords(system, now, x);
    CHECK(relative_error(along, system.law_tangents(now, factors, true)) > 0.01);
    SparseFactor with_chords;
    REQUIRE(with_chords.factor(*matrix.assemble(now, weightless, factors, along)));
    VectorXd expected = b;
    with_chords.solve(expected);
    CHECK(relative_error(x, expected) < 1e-8);
  }
}

TEST_CASE("Any number of laws is followed, and up to three joints") {
  for (int links : {1, 2, 3, 4, 5}) {
    for (int laws = 0; laws <= std::min(links, 3); ++laws) {
      if (links == 1 && laws == 0) continue;  // nothing changes
      CAPTURE(links);
      CAPTURE(laws);
      flexarm::model::Arm arm = two_link_arm();
      for (auto& link : arm.links) std::get<flexarm::model::BeamLink>(link).up = Vector3d::UnitZ();
      arm.links.resize(1);
      arm.joints.resize(1);
      arm.payloads.clear();
      arm.points.clear();
      for (int k = 1; k < links; ++k) {
        const flexarm::model::Arm two = two_link_arm();
        auto link = std::get<flexarm::model::BeamLink>(arm.links.back());
        auto joint = two.joints[1];
        joint.parent = link.name;
        link.name = joint.child = "link " + std::to_string(k);
        joint.name = "joint " + std::to_string(k);
        arm.links.push_back(link);
        arm.joints.push_back(joint);
      }
      for (int k = 0; k < laws; ++k) arm.joints[k].drive_train.stages[0] = {ReducerSpring{500, 0, 1e5}};
      std::map<std::string, DriveKind> drives;
      for (const auto& joint : arm.joints) drives[joint.name] = DriveKind::motor_angle;
      const System system(arm, drives);
      State then = system.rigid_state(std::vector<double>(links, 0.1));
      State now = system.rigid_state(std::vector<double>(links, 0.7));
      for (int k = 0; k < laws; ++k) now.s[system.joints()[k].phi] -= 0.3;
      const auto [corrected, kept] = compare<3>(system, then, now);
      CHECK(kept > 0.01);
      if (links <= 4) CHECK(corrected < 1e-9);  // five links turn four joints: too many to be worth it
    }
  }
}

TEST_CASE("An arm folds at its elbow with one factorisation, in little more than one iteration a step") {
  flexarm::model::Arm arm = two_link_arm();
  for (auto& link : arm.links)
    std::get<flexarm::model::BeamLink>(link).material.youngs_modulus *= 20;  // hardly bends
  const System system(arm, {{"shoulder", DriveKind::motor_angle}, {"elbow", DriveKind::motor_angle}});
  State state = system.rigid_state({0, 0});
  const int elbow = system.joints()[1].phi;
  const VectorXd zero = VectorXd::Zero(system.n_scalars());
  const auto fold = [&](double t, DriveValues& values) {  // from rest, 2 rad within 4 s
    values = {zero, zero, zero, zero};
    values.s[elbow] = 0.125 * t * t;
    values.v[elbow] = 0.25 * t;
    values.v_dot[elbow] = 0.25;
  };
  HhtStepper stepper(system, HhtCoefficients::from_alpha(-0.1), Loads{.gravity = Vector3d::Zero()});
  for (int k = 0; k < 2000; ++k) stepper.advance(state, 2e-3, fold);
  CHECK(state.s[elbow] == near(2));
  CHECK(stepper.statistics().factorisations == 1);
  CHECK(stepper.statistics().iterations < 1.5 * stepper.statistics().steps);
}

}  // namespace flexarm::tests::woodbury_update_test
