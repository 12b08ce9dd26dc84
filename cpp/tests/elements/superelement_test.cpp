#include "flexarm/elements/superelement.hpp"

#include <doctest/doctest.h>

#include "flexarm/errors.hpp"
#include "parts.hpp"

namespace flexarm::tests::superelement_test {

using namespace flexarm::geometry;
using flexarm::elements::BeamElement;
using flexarm::elements::BeamProperties;
using flexarm::elements::SuperElement;
using Configuration = SuperElement::Configuration;

namespace {

const Vector3d g{0.7, -1.1, -9.81};

/// The part somewhere, deformed by relative motions up to `size`.
Configuration placed(const SuperElement& part, const flexarm::model::SuperElementLink& link, Random& random,
                     double size) {
  const Frame H = exp6(random.twist(2, 2));
  Configuration at{{}, random.vector(part.n_modes(), size)};
  for (const Frame& frame : link.frames) {
    at.frames.push_back(H * Frame::translation(frame.x) * exp6(random.twist(0.3 * size, size)));
  }
  return at;
}

Configuration moved(const Configuration& at, const VectorXd& h) {
  Configuration there = at;
  for (std::size_t i = 0; i < at.frames.size(); ++i)
    there.frames[i] = at.frames[i] * exp6(h.segment<6>(6 * static_cast<Eigen::Index>(i)));
  there.eta += h.tail(at.eta.size());
  return there;
}

double potential(const SuperElement& part, const Configuration& at) {
  const auto forces = part.internal_forces(at, VectorXd::Zero(part.size()), g);
  return forces.elastic + forces.gravity;
}

}  // namespace

TEST_CASE("A rigid motion of a super-element gives neither strain nor forces") {
  Random random(1);
  const auto link = tripod();
  const SuperElement part(link, 0, 0);
  const Configuration at = placed(part, link, random, 0);
  CHECK(largest(part.deformation(at)) < 1e-14);
  Vector6d v = random.twist(1, 2);  // of the whole part, in its axes at the first interface
  VectorXd V = VectorXd::Zero(part.size());
  for (int i = 0; i < 3; ++i) V.segment<6>(6 * i) = adjoint(relative(at.frames[i], at.frames[0])) * v;
  const auto forces = part.internal_forces(at, V, Vector3d::Zero());
  const double scale = largest(link.stiffness);
  CHECK(largest(forces.f) < 1e-13 * scale);
  CHECK(forces.dissipation < 1e-20 * scale);
}

TEST_CASE("Forces of a super-element do not change when it moves as a whole") {
  Random random(2);
  const auto link = tripod();
  const SuperElement part(link, 0, 0);
  const Configuration at = placed(part, link, random, 0.2);
  const Frame H = exp6(random.twist(5, 3));
  Configuration there = at;
  for (Frame& frame : there.frames) frame = H * frame;
  const VectorXd V = random.vector(part.size());
  const auto f = part.internal_forces(at, V, g).f;
  CHECK(relative_error(part.internal_forces(there, V, H.R * g).f, f) < 1e-12);
}

TEST_CASE("Forces of a super-element derive from its elastic energy and its potential in gravity") {
  Random random(3);
  const auto link = tripod();
  const SuperElement part(link, 0, 0);
  const Configuration at = placed(part, link, random, 0.3);
  const auto energy = [&](const VectorXd& h) -> VectorXd {
    return VectorXd::Constant(1, potential(part, moved(at, h)));
  };
  const VectorXd f = part.internal_forces(at, VectorXd::Zero(part.size()), g).f;
  CHECK(relative_error(f, differences(energy, part.size()).transpose()) < 1e-9);
}

TEST_CASE("Tangents of a super-element match differences") {
  Random random(4);
  const auto link = tripod();
  const SuperElement part(link, 0, 0);
  const Configuration at = placed(part, link, random, 0.3);
  const VectorXd V = random.vector(part.size()), zero = VectorXd::Zero(part.size());
  const auto of_motion = [&](const VectorXd& h) -> VectorXd {
    return part.internal_forces(moved(at, h), V, g).f;
  };
  const auto of_velocity = [&](const VectorXd& dV) -> VectorXd {
    return part.internal_forces(at, V + dV, g).f;
  };
  const auto inertia = [&](const VectorXd& dV) -> VectorXd { return part.inertia_forces(V + dV, zero); };
  CHECK(relative_error(part.stiffness_matrix(at, V, g), differences(of_motion, part.size())) < 1e-9);
  CHECK(relative_error(part.damping_matrix(at), differences(of_velocity, part.size())) < 1e-9);
  CHECK(relative_error(part.gyroscopic_matrix(V), differences(inertia, part.size())) < 1e-9);
}

TEST_CASE("Two interfaces without modes are the beam element, however far they bend") {
  Random random(5);
  auto like = thin_beam("beam", {0.8, 0, 0}, 1);
  like.up = {0, 0, 1};
  const auto properties = BeamProperties::from(like);
  const Frame start, end = Frame::translation(like.end);
  const BeamElement beam(0, 1, start, end, properties);
  flexarm::model::SuperElementLink link{.name = "beam",
                                        .interfaces = {"a", "b"},
                                        .frames = {start, end},
                                        .stiffness = beam.stiffness_matrix(start, end),
                                        .mass = beam.mass()};
  const SuperElement part(link, 0, 0);
  const Configuration at = placed(part, link, random, 0.6);
  const VectorXd V = random.vector(12), V_dot = random.vector(12);
  const auto expected = beam.internal_forces(at.frames[0], at.frames[1], Vector6d::Zero(), Vector6d::Zero());
  VectorXd f(12);
  f << expected.f1, expected.f2;
  const auto found = part.internal_forces(at, VectorXd::Zero(12), Vector3d::Zero());
  CHECK(relative_error(found.f, f) < 1e-12);
  CHECK(found.elastic == near(expected.energy, 1e-12));
  CHECK(relative_error(part.inertia_forces(V, V_dot), beam.inertia_forces(V, V_dot)) < 1e-14);
}

TEST_CASE("A free super-element keeps its momentum: its forces balance, whatever its shape") {
  Random random(6);
  const auto link = tripod();
  const SuperElement part(link, 0, 0);
  const Configuration at = placed(part, link, random, 0.4);
  const VectorXd V = random.vector(part.size());
  const auto f = part.internal_forces(at, V, Vector3d::Zero()).f;
  Vector6d sum = Vector6d::Zero();  // of wrenches on the base's origin
  for (int i = 0; i < 3; ++i) sum += adjoint(at.frames[i].inverse()).transpose() * f.segment<6>(6 * i);
  CHECK(largest(sum) < 1e-12 * largest(f));
}

TEST_CASE("Gravity acts on a super-element as on the rigid body with its mass and centre") {
  Random random(7);
  const auto link = tripod();
  const SuperElement part(link, 0, 0);
  const Configuration at = placed(part, link, random, 0);
  auto f = part.internal_forces(at, VectorXd::Zero(part.size()), g).f;
  const auto weight = part.weight();
  f.head<6>() -= weight.force(at.frames[0].R, g);
  Vector6d sum = Vector6d::Zero();
  for (int i = 0; i < 3; ++i) sum -= adjoint(at.frames[i].inverse()).transpose() * f.segment<6>(6 * i);

  const auto like = thin_beam("leg", {1, 0, 0}, 1);  // three uniform legs from the origin of the part
  double mass = 0;
  Vector3d moment = Vector3d::Zero();
  for (const Frame& end : link.frames) {
    const double m = like.material.density * like.section.area * end.x.norm();
    mass += m;
    moment += 0.5 * m * end.x;
  }
  const Frame H = at.frames[0] * Frame::translation(-link.frames[0].x);
  const Vector3d first_moment = H * (moment / mass) * mass;
  CHECK(weight.mass == near(mass, 1e-10));
  CHECK(relative_error(sum.head<3>(), mass * g) < 1e-10);
  CHECK(relative_error(sum.tail<3>(), first_moment.cross(g)) < 1e-9);
}

TEST_CASE("How the modes of a part are scaled does not matter to its interfaces") {
  Random random(8);
  const auto link = tripod();
  auto scaled = link;
  VectorXd by = VectorXd::Ones(link.stiffness.rows());
  by.tail(2) << 1e-3, -40;
  for (MatrixXd* matrix : {&scaled.stiffness, &scaled.mass, &scaled.damping})
    *matrix = MatrixXd(by.asDiagonal() * *matrix * by.asDiagonal());
  const SuperElement part(link, 0, 0), other(scaled, 0, 0);
  Configuration at = placed(part, link, random, 0.2), there = at;
  there.eta[1] = -at.eta[1];  // the sign of a mode is free
  VectorXd V = random.vector(part.size()), V_there = V;
  V_there[part.size() - 1] = -V[part.size() - 1];
  const VectorXd f = part.internal_forces(at, V, g).f.head(18);
  CHECK(relative_error(other.internal_forces(there, V_there, g).f.head(18), f) < 1e-12);
  CHECK(relative_error(other.inertia_forces(V_there, V_there).head(18), part.inertia_forces(V, V).head(18)) <
        1e-12);
  CHECK(relative_error(other.shape(there).u.head(18), part.shape(at).u.head(18)) < 1e-12);
}

TEST_CASE("The shape of a part gives the displacements of its interfaces") {
  Random random(9);
  const auto link = tripod();
  const SuperElement part(link, 0, 0);
  const Configuration at = placed(part, link, random, 1e-6);
  const auto shape = part.shape(at);
  for (int i = 0; i < 3; ++i) {
    const Frame undeformed = shape.frame * Frame::translation(link.frames[i].x);
    const Vector6d h = log6(relative(undeformed, at.frames[i]));  // the frame has the part's axes
    CHECK(error(shape.u.segment<6>(6 * i), h) < 1e-11);           // 1e-6 squared, and some
  }
}

TEST_CASE("A damping ratio is that of the part held at its first interface in its lowest mode") {
  auto beam = thin_beam("beam", {0.8, 0, 0}, 8);
  auto link = reduced_beam(beam, 8, 6);
  SuperElement part(link, 0, 0);
  part.set_damping_ratio(0.01);
  // Clamped-free Euler-Bernoulli beam in its soft plane, 1.8751² √(EI/ρA)/L²; shear and rotary inertia of a
  // 0.8 m by 2 cm beam lower it by some 0.1 %.
  const double EI = beam.material.youngs_modulus * beam.section.second_moment_y;
  const double rho_A = beam.material.density * beam.section.area;
  const double omega = 1.8751 * 1.8751 / 0.64 * std::sqrt(EI / rho_A);
  const Configuration at{{link.frames[0], link.frames[1]}, VectorXd::Zero(6)};
  const MatrixXd C = part.damping_matrix(at),
                 K = part.stiffness_matrix(at, VectorXd::Zero(18), Vector3d::Zero());
  CHECK(relative_error(C, 2 * 0.01 / omega * K) < 2e-3);
}

TEST_CASE("Matrices that do not fit a super-element are refused by name") {
  auto link = tripod();
  link.mass.conservativeResize(19, 19);
  CHECK_THROWS_WITH_AS(SuperElement(link, 0, 0), doctest::Contains("link 'tripod': stiffness, mass"),
                       flexarm::InvalidParameter);
  link = tripod();
  link.mass *= -1;
  CHECK_THROWS_WITH_AS(SuperElement(link, 0, 0), doctest::Contains("mass must be positive"),
                       flexarm::InvalidParameter);
}

}  // namespace flexarm::tests::superelement_test
