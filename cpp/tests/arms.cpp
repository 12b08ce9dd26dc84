#include "arms.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace flexarm::tests {

model::Arm paper_arm(const PaperArm& p) {
  model::Arm arm;
  arm.name = "paper";
  arm.links = {model::BeamLink{.name = "tube",
                               .end = {3, 0, 0},
                               .section = paper_tube(),
                               .material = steel(),
                               .theory = p.theory,
                               .elements = p.elements,
                               .damping_ratio = p.damping_ratio}};
  model::Joint hinge{.name = "hinge", .child = "tube", .axis = Vector3d::UnitY()};
  if (p.hub_stiffness > 0) hinge.drive_train = compliant(p.hub_stiffness);
  arm.joints = {hinge};
  arm.payloads = {{.name = "payload", .link = "tube", .position = {3, 0, 0}, .mass = 14.1}};
  arm.points = {{.name = "tip", .link = "tube", .position = {3, 0, 0}, .loaded = true}};
  return arm;
}

model::Arm pendulum(double m, double c, double J) {
  model::Arm arm;
  arm.name = "pendulum";
  arm.links = {model::RigidLink{"bob", m, {0, 0, -c}, Vector3d(J, J, 0.1 * J).asDiagonal()}};
  arm.joints = {{.name = "hinge", .child = "bob", .axis = Vector3d::UnitY()}};
  arm.points = {{.name = "centre", .link = "bob", .position = {0, 0, -c}}};
  return arm;
}

model::BeamLink thin_beam(const std::string& name, const Vector3d& end, int elements) {
  return {.name = name,
          .end = end,
          .up = {0.3, 0.2, 1},
          .section = model::rectangle_section(0.03, 0.02),
          .material = {70e9, 27e9, 2700},
          .elements = elements,
          .damping_ratio = 0.02};
}

model::Arm two_link_arm() {
  model::Arm arm;
  arm.name = "two links";
  arm.links = {thin_beam("upper", {1, 0, 0}, 2), thin_beam("fore", {0.8, 0, 0}, 2)};
  model::Joint shoulder{.name = "shoulder", .child = "upper", .axis = Vector3d::UnitY()};
  shoulder.drive_train = compliant(4000, 3);
  shoulder.drive_train.gear_ratio = 100;
  shoulder.drive_train.rotor_inertia = 2e-5;
  model::Joint elbow{
      .name = "elbow", .parent = "upper", .child = "fore", .at_end = true, .axis = Vector3d::UnitY()};
  elbow.drive_train = compliant(2000, 1);
  arm.joints = {shoulder, elbow};
  arm.payloads = {{.name = "load", .link = "fore", .position = {0.8, 0, 0}, .mass = 1.5}};
  arm.points = {{.name = "tip", .link = "fore", .position = {0.8, 0, 0}, .loaded = true}};
  return arm;
}

model::Arm spatial_arm() {
  model::Arm arm;
  arm.name = "spatial";
  arm.links = {thin_beam("column", {0.1, 0.2, 0.9}, 2),
               model::RigidLink{"carriage", 2.0, {0.05, 0.02, 0.1}, Vector3d(0.02, 0.03, 0.04).asDiagonal()},
               thin_beam("boom", {0.7, 0.1, -0.1}, 2)};
  model::Joint turn{.name = "turn", .child = "column", .axis = Vector3d(0.1, 0.2, 1)};
  turn.origin = geometry::exp6((Vector6d() << 0.1, 0.2, 0.3, 0.2, -0.1, 0.3).finished());
  turn.drive_train = compliant(3000, 2);
  turn.drive_train.motor = {joints::ViscousFriction{0.7}};
  model::Joint slide{.name = "slide", .type = JointType::prismatic, .parent = "column", .child = "carriage"};
  slide.at_end = true;
  slide.origin = geometry::exp6((Vector6d() << 0, 0.05, 0.02, 0.4, 0.1, -0.2).finished());
  slide.axis = Vector3d(1, 0.3, 0.2);
  slide.drive_train.stages = {{ReducerSpring{5000, 4, 1e5}}, {ReducerSpring{9000}}};
  model::Joint lift{.name = "lift", .parent = "carriage", .child = "boom", .axis = Vector3d(0, 1, 0.1)};
  lift.origin = Frame::translation({0.1, 0.05, 0.1});
  lift.drive_train.rotor_inertia = 0.05;
  lift.drive_train.bearing = {joints::ViscousFriction{0.4}, joints::CableTorque{20, -0.1}};
  arm.joints = {turn, slide, lift};
  arm.payloads = {{.name = "tool",
                   .link = "boom",
                   .position = {0.4, 0.1, 0},
                   .mass = 1.2,
                   .inertia = Vector3d(0.01, 0.02, 0.03).asDiagonal(),
                   .offset = {0.02, -0.05, 0.03}}};
  arm.points = {{.name = "tip", .link = "boom", .position = {0.7, 0.1, -0.1}, .loaded = true},
                {.name = "middle", .link = "column", .position = {0.05, 0.1, 0.45}, .loaded = true}};
  return arm;
}

model::Arm crane_arm() {
  model::Arm arm;
  arm.name = "crane";
  arm.links = {thin_beam("boom", {2, 0, 0}, 2),
               model::RigidLink{"cylinder", 3, {0, 0, 0.3}, Vector3d(0.1, 0.1, 0.01).asDiagonal()},
               model::RigidLink{"piston", 1, {0, 0, 0.4}, Vector3d(0.05, 0.05, 0.001).asDiagonal()}};
  const Vector3d axis = -Vector3d::UnitY();
  arm.joints = {{.name = "boom_pin", .child = "boom", .origin = Frame::translation({0, 0, 1}), .axis = axis},
                {.name = "cylinder_pin",
                 .child = "cylinder",
                 .origin = Frame::translation({0.3, 0, 0.2}),
                 .axis = axis},
                {.name = "piston",
                 .type = JointType::prismatic,
                 .parent = "cylinder",
                 .child = "piston",
                 .axis = Vector3d::UnitZ()}};
  arm.closures = {{.name = "rod_eye",
                   .a = "piston",
                   .b = "boom",
                   .a_origin = Frame::translation({0, 0, 0.9}),
                   .b_origin = Frame::translation({1.2, 0, -0.1}),
                   .axis = axis}};
  arm.payloads = {{.name = "load", .link = "boom", .position = {2, 0, 0}, .mass = 1.5}};
  arm.points = {{.name = "tip", .link = "boom", .position = {2, 0, 0}, .loaded = true}};
  return arm;
}

model::Arm rigid_crane_arm() {
  model::Arm arm = crane_arm();
  arm.links[0] = model::RigidLink{"boom", 8, {1, 0.02, 0}, Vector3d(0.1, 3, 3).asDiagonal()};
  return arm;
}

void satisfy_constraints(const System& system, State& state) {
  VectorXd phi(system.n_constraints());
  for (int k = 0; k < 8; ++k) {
    system.violation(state, phi);
    const MatrixXd J = system.constraint_jacobian(state);
    const VectorXd dx = -(J.transpose() * (J * J.transpose()).ldlt().solve(phi));
    integrators::move(system, dx, state);
  }
}

State random_state(const System& system, unsigned seed, double size) {
  Random random(seed);
  State state = system.rigid_state(std::vector<double>(system.arm().joints.size(), 0.4));
  for (Frame& H : state.frames) H = H * geometry::exp6(random.twist(0.3 * size, size));
  state.s += random.vector(state.s.size(), size);
  state.v = random.vector(state.v.size());
  state.v_dot = random.vector(state.v.size());
  state.multipliers = random.vector(state.multipliers.size(), 20);
  satisfy_constraints(system, state);
  return state;
}

void balance(const System& system, const Loads& loads, State& state) {
  const int n = system.n_free();
  state.v_dot.setZero();
  state.multipliers.setZero();
  VectorXd r(system.n_velocities()), rhs(system.n_unknowns());
  system.residual(state, loads, true, r);
  const VectorXd v = state.v.head(n);
  const double h = 1e-4;
  const auto rate_at = [&](double t) -> VectorXd {
    State there = state;
    integrators::move(system, t * v, there);
    return system.constraint_jacobian(there) * v;
  };
  rhs << -r.head(n), -(rate_at(h) - rate_at(-h)) / (2 * h);
  const MatrixXd S = system.tangent(state, loads, {1, 0, 0});
  const VectorXd x = S.fullPivLu().solve(rhs);
  state.v_dot.head(n) = x.head(n);
  state.a = state.v_dot;
  state.multipliers = x.tail(system.n_constraints());
}

}  // namespace flexarm::tests
