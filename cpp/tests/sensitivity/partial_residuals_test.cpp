#include "flexarm/sensitivity/partial_residuals.hpp"

#include "arms.hpp"
#include "parts.hpp"

namespace flexarm::tests::partial_residuals_test {

using namespace flexarm::sensitivity;
using namespace flexarm::simulation;
namespace joints = flexarm::joints;
namespace model = flexarm::model;

namespace {

using Drives = std::map<std::string, DriveKind>;
using Change = std::function<void(model::Arm&, double)>;

model::BeamLink& beam(model::Arm& arm, int k) { return std::get<model::BeamLink>(arm.links[k]); }

/// Half a turn of the column's motor makes a wave; its friction has a memory.
model::Arm rich_arm() {
  model::Arm arm = spatial_arm();
  for (int k : {0, 2}) beam(arm, k).damping_ratio = 0.02;
  beam(arm, 0).bow = {0.01, -0.005, 0};
  beam(arm, 2).bow = {0.0, 0.02, 0.01};
  beam(arm, 2).bow_time = 0.5;
  arm.joints[0].drive_train.transmission =
      joints::Transmission{.scale = 1.1, .amplitude = 0.02, .multiple = 6, .phase = 0.4};
  arm.joints[2].drive_train.motor = {joints::DahlFriction{3, 0.05}};
  return arm;
}

const Drives moving = {
    {"turn", DriveKind::torque}, {"slide", DriveKind::motor_angle}, {"lift", DriveKind::free}};
const Drives led = {
    {"turn", DriveKind::motor_angle}, {"slide", DriveKind::link_angle}, {"lift", DriveKind::torque}};

/// Everything that a model can change, by an amount relative to its size.
const std::vector<std::pair<std::string, Change>> changes = {
    {"Young's modulus", [](model::Arm& a, double d) { beam(a, 0).material.youngs_modulus *= 1 + d; }},
    {"density", [](model::Arm& a, double d) { beam(a, 2).material.density *= 1 + d; }},
    {"damping", [](model::Arm& a, double d) { beam(a, 0).damping_ratio *= 1 + d; }},
    {"length", [](model::Arm& a, double d) { beam(a, 2).end *= 1 + d; }},
    {"bow", [](model::Arm& a, double d) { beam(a, 0).bow *= 1 + d; }},
    {"time of a bow", [](model::Arm& a, double d) { beam(a, 2).bow_time *= 1 + d; }},
    {"rigid mass", [](model::Arm& a, double d) { std::get<model::RigidLink>(a.links[1]).mass *= 1 + d; }},
    {"payload", [](model::Arm& a, double d) { a.payloads[0].mass *= 1 + d; }},
    {"payload's place", [](model::Arm& a, double d) { a.payloads[0].offset.y() += d; }},
    {"loaded point", [](model::Arm& a, double d) { a.points[0].position.z() += d; }},
    {"axis", [](model::Arm& a, double d) { a.joints[1].axis.y() += d; }},
    {"origin", [](model::Arm& a, double d) { a.joints[2].origin.x.x() += d; }},
    {"rotor", [](model::Arm& a, double d) { a.joints[2].drive_train.rotor_inertia *= 1 + d; }},
    {"ripple", [](model::Arm& a, double d) { a.joints[0].drive_train.transmission->amplitude *= 1 + d; }},
    {"spring",
     [](model::Arm& a, double d) {
       std::get<ReducerSpring>(a.joints[1].drive_train.stages[0][0]).cubic_stiffness *= 1 + d;
     }},
    {"friction",
     [](model::Arm& a, double d) {
       std::get<joints::DahlFriction>(a.joints[2].drive_train.motor[0]).torque *= 1 + d;
     }},
};

constexpr double step = 3e-5;  // of the differences, as a run takes it

struct Beside {
  System plus, minus;
};

std::vector<Beside> beside(const Drives& drives) {
  std::vector<Beside> models;
  for (const auto& [name, change] : changes) {
    model::Arm up = rich_arm(), down = rich_arm();
    change(up, step);
    change(down, -step);
    models.push_back({System(up, drives), System(down, drives)});
  }
  return models;
}

State moving_state(const System& system, unsigned seed) {
  State state = random_state(system, seed);
  state.t = 0.3;
  Random random(seed);
  for (joints::LawMemory& memory : state.laws) memory = {random(-0.02, 0.02), random(-0.3, 0.3)};
  return state;
}

Loads pushing(const System& system) {
  Loads loads{.gravity = {1, -2, -9}};
  loads.points.push_back({0, {3, -5, 2}, {1, 0.5, -2}, false});
  loads.points.push_back({0, {-1, 4, 2}, {0.3, 1.5, -1}, true});
  loads.torques = VectorXd::LinSpaced(system.n_scalars(), 1, 2);
  return loads;
}

VectorXd equations(const System& system, const State& state, const Loads& loads) {
  VectorXd r(system.n_velocities()), phi(system.n_constraints()), both(system.n_unknowns());
  system.residual(state, loads, true, r);
  system.violation(state, phi);
  both << r.head(system.n_free()), phi;
  return both;
}

}  // namespace

// Both differences have the same step: they differ by rounding, 1e-16 of the largest force over the step, and
// by h² of what is linearised analytically.
TEST_CASE("What parameters do to the equations is what residuals of two whole models differ by") {
  for (const Drives& drives : {moving, led}) {
    const System system(rich_arm(), drives);
    const std::vector<Beside> models = beside(drives);
    std::vector<Variation> variations;
    for (const Beside& each : models) variations.push_back({&each.plus, &each.minus, step, -step, {}, {}});
    const auto n = static_cast<Eigen::Index>(variations.size());
    for (unsigned seed : {1u, 2u}) {
      const State state = moving_state(system, seed);
      const Loads loads = pushing(system);
      StateDerivative derivative(system, n);
      Random random(seed + 10);
      for (Eigen::Index k = 0; k < n; ++k) {
        derivative.law_x.col(k) = random.vector(derivative.law_x.rows(), 0.1);
        derivative.law_z.col(k) = random.vector(derivative.law_z.rows());
      }
      LawSlopesIn<3> laws(system, variations);
      PartialResidualsIn<3> partial(system, variations);
      laws.evaluate(state, true);
      Slopes rhs;
      partial.prescribe(state.t, derivative);
      partial.evaluate(state, derivative, loads, laws, rhs);
      const double size = largest(equations(system, state, loads));
      for (Eigen::Index k = 0; k < n; ++k) {
        const auto at = [&](const System& model, double amount) {
          State there = state;
          for (std::size_t law = 0; law < state.laws.size(); ++law) {
            there.laws[law].x += amount * derivative.law_x(static_cast<Eigen::Index>(law), k);
            there.laws[law].z += amount * derivative.law_z(static_cast<Eigen::Index>(law), k);
          }
          return equations(model, there, loads);
        };
        const VectorXd expected = (at(models[k].minus, -step) - at(models[k].plus, step)) / (2 * step);
        CAPTURE(changes[k].first);
        CHECK(largest(expected) > 0);
        CHECK(largest(rhs.col(k) - expected) < 1e-7 * largest(expected) + 1e-10 * size);
      }
    }
  }
}

TEST_CASE("Drives that depend on a parameter reach laws, joints and gears through their coordinates") {
  const System system(rich_arm(), led);
  const State state = moving_state(system, 3);
  const Loads loads = pushing(system);
  const int n_driven = system.n_velocities() - system.n_free();
  REQUIRE(n_driven == 2);
  const VectorXd way = VectorXd::LinSpaced(system.n_scalars(), 0.5, 1.5);
  const auto drive = [&](double amount) {
    return [&, amount](double, flexarm::integrators::DriveValues& values) {
      values.s = amount * way;
      values.v = 2 * amount * way;
      values.v_dot = -amount * way;
      values.torques = 3 * amount * way;
    };
  };
  const std::vector<Variation> variations = {{&system, &system, step, -step, drive(step), drive(-step)}};
  StateDerivative derivative(system, 1);
  LawSlopesIn<3> laws(system, variations);
  PartialResidualsIn<3> partial(system, variations);
  laws.evaluate(state, true);
  partial.prescribe(state.t, derivative);
  Slopes rhs;
  partial.evaluate(state, derivative, loads, laws, rhs);
  const auto at = [&](double amount) {
    State there = state;
    there.s.tail(n_driven) += amount * way.tail(n_driven);
    there.v.tail(n_driven) += 2 * amount * way.tail(n_driven);
    there.v_dot.tail(n_driven) -= amount * way.tail(n_driven);
    Loads pulled = loads;
    pulled.torques += 3 * amount * way;
    return equations(system, there, pulled);
  };
  const VectorXd expected = (at(-step) - at(step)) / (2 * step);
  CHECK(relative_error(rhs.col(0), expected) < 1e-7);
}

}  // namespace flexarm::tests::partial_residuals_test
