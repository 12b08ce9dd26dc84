#include "flexarm/integrators/rigid_joint_condensation.hpp"

#include <doctest/doctest.h>

#include "arms.hpp"
#include "flexarm/integrators/hht.hpp"
#include "flexarm/simulation/statics.hpp"

namespace flexarm::tests::rigid_joint_condensation_test {

using flexarm::assembly::JointCoordinates;
using flexarm::integrators::DriveValues;
using flexarm::integrators::HhtCoefficients;
using flexarm::integrators::HhtStepper;
using flexarm::integrators::RigidJointCondensationIn;
using Condensation = RigidJointCondensationIn<3>;

namespace {

/// base | post | column | plate - hinge - boom | tail, with | a rigid joint between turned frames. The hinge
/// stands on a node that follows another one; the tail comes before the boom, so that the boom follows it.
flexarm::model::Arm welded_arm() {
  using flexarm::model::Joint;
  using flexarm::model::RigidLink;
  const auto body = [](const std::string& name, double mass) {
    return RigidLink{name, mass, {0.02, 0.01, 0.03}, Vector3d(0.01, 0.02, 0.03).asDiagonal()};
  };
  flexarm::model::Arm arm;
  arm.name = "welded";
  arm.links = {thin_beam("post", {0.1, 0, 0.4}, 1), thin_beam("column", {0, 0.2, 0.6}, 2), body("plate", 1.0),
               body("tail", 0.8), thin_beam("boom", {0.7, 0.1, -0.1}, 2)};
  const auto weld = [](const std::string& name, const std::string& parent, const std::string& child,
                       unsigned seed) {
    Joint joint{.name = name, .type = JointType::fixed, .parent = parent, .child = child};
    joint.at_end = parent != "base" && parent != "plate";
    joint.origin = flexarm::geometry::exp6(Random(seed).twist(0.1, 0.7));
    return joint;
  };
  Joint hinge{.name = "hinge", .parent = "plate", .child = "boom", .axis = Vector3d(0.2, 1, 0.1)};
  hinge.drive_train = compliant(2000, 3);
  arm.joints = {weld("clamp", "base", "post", 1), weld("bolts", "post", "column", 2),
                weld("flange", "column", "plate", 3), hinge, weld("glue", "boom", "tail", 4)};
  return arm;
}

const std::map<std::string, DriveKind> drives = {{"hinge", DriveKind::motor_angle}};

/// Steps of 2 ms from rest while the motor turns; multipliers recovered.
State moved(const System& system, bool condense, flexarm::integrators::HhtStatistics& statistics) {
  const Loads gravity;
  State state = flexarm::simulation::static_equilibrium(system, {0, 0, 0, 0, 0}, gravity).state;
  const int phi = system.joints()[3].phi;
  const VectorXd zero = VectorXd::Zero(system.n_scalars());
  HhtStepper stepper(system, HhtCoefficients::from_alpha(-0.1), gravity,
                     {.tolerance = 1e-13, .acceleration_tolerance = 1e-9, .condense = condense});
  for (int k = 0; k < 300; ++k) {
    stepper.advance(state, 2e-3, [&](double t, DriveValues& values) {
      values = {zero, zero, zero, zero};
      values.s[phi] = 2 * t * t;
      values.v[phi] = 4 * t;
      values.v_dot[phi] = 4;
    });
  }
  stepper.recover_multipliers(state);
  statistics = stepper.statistics();
  return state;
}

}  // namespace

TEST_CASE("Welded nodes move as rigid joints move them, with the same forces") {
  const System system(welded_arm(), drives);
  flexarm::integrators::HhtStatistics apart, together;
  const State expected = moved(system, false, apart), state = moved(system, true, together);
  // Iterations end at 1e-9 of accelerations; what is left differs between the two.
  for (int k = 0; k < system.n_nodes(); ++k) {
    CHECK(error(state.frames[k].x, expected.frames[k].x) < 1e-9);
    CHECK((state.frames[k].R - expected.frames[k].R).norm() < 1e-9);
  }
  CHECK(relative_error(state.v, expected.v) < 1e-6);
  CHECK(relative_error(state.v_dot, expected.v_dot) < 1e-6);
  CHECK(relative_error(state.multipliers, expected.multipliers) < 1e-6);
  CHECK(together.factorisations == apart.factorisations);
  CHECK(together.iterations < 1.02 * static_cast<double>(apart.iterations));
  VectorXd phi(system.n_constraints());
  system.violation(state, phi);
  CHECK(largest(phi) < 1e-11);
}

TEST_CASE("Each node of a body follows one carrier; what hangs on the base rests") {
  const System system(welded_arm(), drives);
  const Condensation condensation(system, true);
  // Nodes: post 0 1, column 2 3 4, plate 5, tail 6, boom 7 8 9.
  CHECK(condensation.carriers() == std::vector<int>{1, 3, 4, 6, 7, 8});
  CHECK(condensation.joints() == std::vector<bool>{true, true, true, false, true});
  CHECK(condensation.n_unknowns() == 6 * 6 + 1 + 6);
  CHECK(condensation.place_of(0).row == Condensation::none);
  CHECK(condensation.place_of(5).row == condensation.place_of(4).row);
  CHECK_FALSE(Condensation(system, false).any());
  CHECK(Condensation(system, false).n_unknowns() == system.n_unknowns());
}

TEST_CASE("fold, unfold and reduce are products with one matrix") {
  const System system(welded_arm(), drives);
  const Condensation condensation(system, true);
  Random random(9);
  const State state = random_state(system, 3);
  const Eigen::SparseMatrix<double> S = system.tangent(state, {}, {2, 3, 1});
  const VectorXd y = random.vector(condensation.n_unknowns()), z = random.vector(condensation.n_unknowns());
  VectorXd Ty(system.n_unknowns()), Tz(system.n_unknowns()), b = random.vector(system.n_unknowns()),
                                                             Tb(condensation.n_unknowns());
  condensation.expand(y, Ty);
  condensation.expand(z, Tz);
  const double work = Ty.dot(b);
  condensation.condense(b, Tb);
  CHECK(y.dot(Tb) == near(work, 1e-12));
  CHECK(y.dot(condensation.reduce(S) * z) == near(Ty.dot(S * Tz), 1e-12));
}

TEST_CASE("A rigid joint that closes a loop stays a constraint") {
  flexarm::model::Arm arm = welded_arm();
  arm.joints.push_back(arm.joints[1]);
  arm.joints.back().name = "twin";
  const System system(arm, drives);
  CHECK(Condensation(system, true).joints() == std::vector<bool>{true, true, true, false, true, false});
}

TEST_CASE("An arm that rests as a whole is left as it is") {
  flexarm::model::Arm arm;
  arm.name = "statue";
  arm.links = {flexarm::model::RigidLink{"block", 1.0, Vector3d::Zero(), 0.1 * Matrix3d::Identity()}};
  arm.joints = {{.name = "clamp", .type = JointType::fixed, .child = "block"}};
  const System system(arm, {});
  CHECK_FALSE(Condensation(system, true).any());
}

}  // namespace flexarm::tests::rigid_joint_condensation_test
