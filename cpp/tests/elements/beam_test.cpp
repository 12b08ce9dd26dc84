#include "flexarm/elements/beam.hpp"

#include <doctest/doctest.h>

#include "beams.hpp"
#include "numerics.hpp"

namespace flexarm::tests::beam_test {

using namespace flexarm::geometry;
using flexarm::elements::BeamElement;
using flexarm::elements::BeamProperties;
using flexarm::elements::Matrix12d;
using flexarm::elements::Vector12d;

namespace {

constexpr double L = 0.8;
constexpr double rigid_in_shear = std::numeric_limits<double>::infinity();

BeamProperties without_shear_and_rotary_inertia() {
  BeamProperties p = plump;
  p.GAy = p.GAz = rigid_in_shear;
  p.rho_Iy = p.rho_Iz = 0;
  return p;
}

BeamElement straight(const BeamProperties& p = plump, double eta = 0) { return straight_beam(L, p, eta); }

/// A deformed element anywhere in space: relative rotations up to about 1 rad.
struct Placement {
  Frame H1, H2;
};
Placement deformed(Random& random, double strain = 0.5) {
  const Frame H1 = exp6(random.twist(2, 2));
  Vector6d d = random.twist(0.3 * strain * L, strain);
  d[0] += L;
  return {H1, H1 * exp6(d)};
}

const Vector6d at_rest = Vector6d::Zero();

Vector12d forces(const BeamElement& beam, const Placement& p, const Vector12d& v = Vector12d::Zero()) {
  const auto f = beam.internal_forces(p.H1, p.H2, v.head<6>(), v.tail<6>());
  Vector12d both;
  both << f.f1, f.f2;
  return both;
}

Placement moved(const Placement& p, const VectorXd& h) {
  return {p.H1 * exp6(h.head<6>()), p.H2 * exp6(h.tail<6>())};
}

/// Rows and columns of (w₁, θ₁, w₂, θ₂) in the x-y plane, or of (w₁, −θ₁, w₂, −θ₂) in the x-z plane.
Eigen::Matrix4d bending_block(const Matrix12d& A, bool xy) {
  const std::array<int, 4> at = xy ? std::array{1, 5, 7, 11} : std::array{2, 4, 8, 10};
  Eigen::Matrix4d B;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const double sign = xy || (i + j) % 2 == 0 ? 1 : -1;
      B(i, j) = sign * A(at[i], at[j]);
    }
  return B;
}

/// [p q r s; . t −s u; . . p −q; . . . t], the pattern of bending mass matrices.
Eigen::Matrix4d mass_pattern(double p, double q, double r, double s, double t, double u) {
  Eigen::Matrix4d A;
  A << p, q, r, s, q, t, -s, u, r, -s, p, -q, s, u, -q, t;
  return A;
}

/// Consistent mass of a Timoshenko beam as published (Przemieniecki 1968, section 11; Friedman 1993).
Eigen::Matrix4d published_mass(double rho_A, double rho_I, double Phi) {
  const double P = Phi, P2 = Phi * Phi;
  const double moving = rho_A * L / ((1 + P) * (1 + P)), turning = rho_I / ((1 + P) * (1 + P) * L);
  return moving * mass_pattern(13.0 / 35 + 7 * P / 10 + P2 / 3, (11.0 / 210 + 11 * P / 120 + P2 / 24) * L,
                               9.0 / 70 + 3 * P / 10 + P2 / 6, -(13.0 / 420 + 3 * P / 40 + P2 / 24) * L,
                               (1.0 / 105 + P / 60 + P2 / 120) * L * L,
                               -(1.0 / 140 + P / 60 + P2 / 120) * L * L) +
         turning * mass_pattern(6.0 / 5, (1.0 / 10 - P / 2) * L, -6.0 / 5, (1.0 / 10 - P / 2) * L,
                                (2.0 / 15 + P / 6 + P2 / 3) * L * L, (-1.0 / 30 - P / 6 + P2 / 6) * L * L);
}

}  // namespace

TEST_CASE("Rigid motion strains nothing") {
  Random random(1);
  const BeamElement beam = straight(plump, 0.1);
  for (int n = 0; n < 10; ++n) {
    const Frame H = exp6(random.twist(5, 3));
    const Vector6d u = random.twist(3, 3);
    const Vector6d v1 = adjoint(H.inverse()) * u;
    const Vector6d v2 = adjoint(Frame::translation({-L, 0, 0})) * v1;
    const auto f = beam.internal_forces(H, H * Frame::translation({L, 0, 0}), v1, v2);
    CHECK(largest(f.f1) < 1e-11);
    CHECK(largest(f.f2) < 1e-11);
    CHECK(f.energy < 1e-24);
    CHECK(f.dissipation < 1e-24);
  }
}

TEST_CASE("Forces in local axes do not change when a deformed element moves as a rigid body") {
  Random random(2);
  const BeamElement beam = straight();
  for (int n = 0; n < 5; ++n) {
    const Placement p = deformed(random);
    const Frame Q = exp6(random.twist(3, 3));
    CHECK(relative_error(forces(beam, {Q * p.H1, Q * p.H2}), forces(beam, p)) < 1e-13);
    CHECK(relative_error(beam.stiffness_matrix(Q * p.H1, Q * p.H2), beam.stiffness_matrix(p.H1, p.H2)) <
          1e-13);
  }
}

TEST_CASE("Internal forces balance: no net force, no net moment") {
  Random random(3);
  const BeamElement beam = straight();
  for (int n = 0; n < 5; ++n) {
    const Placement p = deformed(random);
    const Vector12d f = forces(beam, p);
    // A wrench in a node's axes, moved to the origin, is Ad(H⁻¹)ᵀ f.
    const Vector6d sum =
        adjoint(p.H1.inverse()).transpose() * f.head<6>() + adjoint(p.H2.inverse()).transpose() * f.tail<6>();
    CHECK(largest(sum) < 1e-12 * largest(f));
  }
}

TEST_CASE("Internal forces are the gradient of the elastic energy") {
  Random random(4);
  const BeamElement beam = straight();
  for (int n = 0; n < 5; ++n) {
    const Placement p = deformed(random);
    const auto energy = [&](const VectorXd& h) -> VectorXd {
      const Placement q = moved(p, h);
      return VectorXd::Constant(1, beam.internal_forces(q.H1, q.H2, at_rest, at_rest).energy);
    };
    CHECK(relative_error(forces(beam, p).transpose(), differences(energy, 12)) < 1e-9);
  }
}

TEST_CASE("The stiffness matrix is the derivative of the internal forces, rotations of 1 rad included") {
  Random random(5);
  const BeamElement beam = straight();
  for (double strain : {1e-3, 0.1, 0.6, 1.0}) {
    const Placement p = deformed(random, strain);
    const auto f = [&](const VectorXd& h) -> VectorXd { return forces(beam, moved(p, h)); };
    CAPTURE(strain);
    CHECK(relative_error(beam.stiffness_matrix(p.H1, p.H2), differences(f, 12)) < 1e-8);
  }
}

TEST_CASE("In motion the stiffness matrix counts how damping forces turn and change with the strain") {
  Random random(7);
  BeamElement beam = straight();
  beam.set_damping_time(0.02);
  const Placement p = deformed(random, 0.5);
  const Vector6d v1 = random.twist(2, 2), v2 = random.twist(2, 2);
  const auto f = [&](const VectorXd& h) -> VectorXd {
    const Placement q = moved(p, h);
    const auto found = beam.internal_forces(q.H1, q.H2, v1, v2);
    Vector12d both;
    both << found.f1, found.f2;
    return both;
  };
  CHECK(relative_error(beam.stiffness_matrix(p.H1, p.H2, v1, v2), differences(f, 12)) < 1e-8);
}

TEST_CASE("The stiffness matrix is symmetric without load, and under load lacks the bracket of its forces") {
  Random random(6);
  const BeamElement beam = straight();
  const Matrix12d K0 = beam.stiffness_matrix(Frame{}, Frame::translation({L, 0, 0}));
  CHECK(error(K0, K0.transpose()) < 1e-12 * largest(K0));
  // Increments of a node do not commute: the derivatives D of the energy differ by D_j D_i − D_i D_j = f·[j,
  // i].
  const Placement p = deformed(random);
  const Matrix12d K = beam.stiffness_matrix(p.H1, p.H2);
  const Vector12d f = forces(beam, p);
  Matrix12d bracket = Matrix12d::Zero();
  for (int end = 0; end < 2; ++end) {
    bracket.block<6, 6>(6 * end, 6 * end) = ad_transpose_by_twist(f.segment<6>(6 * end));
  }
  CHECK(relative_error(K - K.transpose(), bracket) < 1e-11);
}

TEST_CASE("The undeformed stiffness is the textbook matrix of a Timoshenko beam, in both planes") {
  const BeamElement beam = straight();
  const Matrix12d K = beam.stiffness_matrix(Frame{}, Frame::translation({L, 0, 0}));
  const auto textbook = [](double EI, double GA) {
    const double Phi = 12 * EI / (GA * L * L);
    Eigen::Matrix4d A;
    A << 12, 6 * L, -12, 6 * L,                               //
        6 * L, (4 + Phi) * L * L, -6 * L, (2 - Phi) * L * L,  //
        -12, -6 * L, 12, -6 * L,                              //
        6 * L, (2 - Phi) * L * L, -6 * L, (4 + Phi) * L * L;
    return Eigen::Matrix4d(EI / (L * L * L * (1 + Phi)) * A);
  };
  CHECK(relative_error(bending_block(K, true), textbook(plump.EIz, plump.GAy)) < 1e-13);
  CHECK(relative_error(bending_block(K, false), textbook(plump.EIy, plump.GAz)) < 1e-13);
  CHECK(K(0, 0) == near(plump.EA / L));
  CHECK(K(0, 6) == near(-plump.EA / L));
  CHECK(K(3, 3) == near(plump.GJ / L));
  CHECK(K(3, 9) == near(-plump.GJ / L));
}

TEST_CASE("Damping is the derivative of the forces by the rates, and takes power") {
  Random random(7);
  const BeamElement beam = straight(plump, 0.03);
  const Placement p = deformed(random);
  const Vector12d v = random.vector(12);
  const auto f = [&](const VectorXd& d) -> VectorXd { return forces(beam, p, v + d); };
  const Matrix12d C = beam.damping_matrix(p.H1, p.H2);
  CHECK(relative_error(C, differences(f, 12)) < 1e-11);
  CHECK(error(C, C.transpose()) < 1e-13 * largest(C));
  const auto out = beam.internal_forces(p.H1, p.H2, v.head<6>(), v.tail<6>());
  CHECK(out.dissipation == near(v.dot(C * v), 1e-12));
  CHECK(out.dissipation > 0);
}

TEST_CASE("The gyroscopic matrix is the derivative of the inertia forces, which take no power") {
  Random random(8);
  const BeamElement beam = straight();
  const Vector12d v = random.vector(12), v_dot = random.vector(12);
  const auto f = [&](const VectorXd& d) -> VectorXd { return beam.inertia_forces(v + d, v_dot); };
  CHECK(relative_error(beam.gyroscopic_matrix(v), differences(f, 12)) < 1e-11);
  CHECK(std::abs(v.dot(beam.inertia_forces(v, Vector12d::Zero()))) < 1e-13);
}

TEST_CASE("Tangents that are found together are those that are found one by one") {
  Random random(10);
  const BeamElement beam = straight(plump, 0.03);
  const Placement p = deformed(random);
  const Vector12d v = random.vector(12);
  BeamElement::TangentMatrices found;
  beam.find_tangents(p.H1, p.H2, v, 0, true, true, found);
  CHECK(found.stiffness == beam.stiffness_matrix(p.H1, p.H2, v.head<6>(), v.tail<6>()));
  CHECK(found.damping == beam.damping_matrix(p.H1, p.H2) + beam.gyroscopic_matrix(v));
}

TEST_CASE("A rigidly moving element has the kinetic energy of a straight rod") {
  Random random(9);
  const BeamElement beam = straight();
  const double m = plump.rho_A * L;
  for (int n = 0; n < 5; ++n) {
    const Vector6d v1 = random.twist(2, 2);
    const Vector6d v2 = adjoint(Frame::translation({-L, 0, 0})) * v1;
    const Vector3d omega = v1.tail<3>(), v_centre = v1.head<3>() + omega.cross(Vector3d(L / 2, 0, 0));
    const Vector3d J =
        Vector3d(plump.rho_J, plump.rho_Iy, plump.rho_Iz) * L + Vector3d(0, 1, 1) * m * L * L / 12;
    const double T = 0.5 * m * v_centre.squaredNorm() + 0.5 * omega.dot(J.cwiseProduct(omega));
    Vector12d v;
    v << v1, v2;
    CHECK(0.5 * v.dot(beam.mass() * v) == near(T, 1e-13));
  }
  CHECK(beam.mass_total() == near(m));
}

TEST_CASE("Without shear and rotary inertia the mass is Hermite's: 156, 22 L, 54, 13 L, 4 L², 3 L²") {
  const Matrix12d M = straight(without_shear_and_rotary_inertia()).mass();
  const Eigen::Matrix4d hermite =
      plump.rho_A * L / 420 * mass_pattern(156, 22 * L, 54, -13 * L, 4 * L * L, -3 * L * L);
  CHECK(relative_error(bending_block(M, true), hermite) < 1e-13);
  CHECK(relative_error(bending_block(M, false), hermite) < 1e-13);
  CHECK(M(0, 0) == near(plump.rho_A * L / 3));
  CHECK(M(0, 6) == near(plump.rho_A * L / 6));
  CHECK(M(3, 3) == near(plump.rho_J * L / 3));
  CHECK(M(3, 9) == near(plump.rho_J * L / 6));
}

TEST_CASE("With shear and rotary inertia the mass is the published consistent Timoshenko matrix") {
  const Matrix12d M = straight().mass();
  const double Phi_y = 12 * plump.EIz / (plump.GAy * L * L), Phi_z = 12 * plump.EIy / (plump.GAz * L * L);
  CHECK(relative_error(bending_block(M, true), published_mass(plump.rho_A, plump.rho_Iz, Phi_y)) < 1e-13);
  CHECK(relative_error(bending_block(M, false), published_mass(plump.rho_A, plump.rho_Iy, Phi_z)) < 1e-13);
}

TEST_CASE("Its shear and rotary inertia appear with Timoshenko's theory only") {
  const flexarm::model::Section section{1e-3, 2e-6, 3e-6, 5e-6, 5e-4, 6e-4};
  const flexarm::model::Material steel{210e9, 80e9, 7850};
  const auto t = BeamProperties::from(section, steel, flexarm::model::BeamTheory::timoshenko);
  const auto e = BeamProperties::from(section, steel, flexarm::model::BeamTheory::euler_bernoulli);
  CHECK(t.GAy == near(80e9 * 5e-4));
  CHECK(t.GAz == near(80e9 * 6e-4));
  CHECK(t.rho_Iy == near(7850 * 2e-6));
  CHECK(t.rho_Iz == near(7850 * 3e-6));
  CHECK(std::isinf(e.GAy));
  CHECK(e.rho_Iy == 0);
  CHECK(e.rho_J == near(t.rho_J));  // inertia against twist stays
  CHECK(e.EIz == near(210e9 * 3e-6));
  CHECK(e.EA == near(210e9 * 1e-3));
}

TEST_CASE("The interpolated section passes through both nodes") {
  Random random(10);
  const BeamElement beam = straight();
  const Placement p = deformed(random);
  const Frame start = beam.interpolate(p.H1, p.H2, 0), end = beam.interpolate(p.H1, p.H2, 1);
  CHECK(error(start.R, p.H1.R) < 1e-14);
  CHECK(error(start.x, p.H1.x) < 1e-14);
  CHECK(error(end.R, p.H2.R) < 1e-13);
  CHECK(error(end.x, p.H2.x) < 1e-13);
}

TEST_CASE("Small deflections follow the cubic of beam theory") {
  const BeamElement beam = straight(without_shear_and_rotary_inertia());
  // What the interpolation leaves out is of third order in the deflection, below 1e-11 here.
  const double w = 2e-4 * L, theta = -3e-4;
  for (bool xy : {true, false}) {
    Frame H2;
    H2.x = xy ? Vector3d(L, w, 0) : Vector3d(L, 0, w);
    H2.R = exp3(xy ? Vector3d(0, 0, theta) : Vector3d(0, -theta, 0));
    for (double xi : {0.2, 0.5, 0.9}) {
      const double x2 = xi * xi, x3 = x2 * xi;
      const double cubic = (3 * x2 - 2 * x3) * w + (x3 - x2) * L * theta;
      const double slope = 6 * (xi - x2) * w / L + (3 * x2 - 2 * xi) * theta;
      const Frame H = beam.interpolate(Frame{}, H2, xi);
      CAPTURE(xi);
      CHECK(std::abs(H.x[xy ? 1 : 2] - cubic) < 1e-11);
      CHECK(std::abs(log3(H.R)[xy ? 2 : 1] - (xy ? slope : -slope)) < 1e-11);
    }
  }
}

TEST_CASE("A circular arc stays an arc: constant curvature is interpolated exactly") {
  const BeamElement beam = straight();
  const Vector6d d = (Vector6d() << L, 0, 0, 0, 0, 1.2).finished();
  for (double xi : {0.25, 0.5, 0.75}) {
    const Frame H = beam.interpolate(Frame{}, exp6(d), xi);
    const double R = L / 1.2;
    CHECK(error(H.x, Vector3d(R * std::sin(1.2 * xi), R * (1 - std::cos(1.2 * xi)), 0)) < 1e-14);
  }
}

TEST_CASE("The velocity of a section is the rate of its interpolated placement") {
  Random random(11);
  const BeamElement beam = straight();
  for (double xi : {0.0, 0.3, 0.8, 1.0}) {
    const Placement p = deformed(random);
    const Vector12d v = random.vector(12);
    const Frame H = beam.interpolate(p.H1, p.H2, xi);
    const auto motion = [&](const VectorXd& t) -> VectorXd {
      const Placement q = moved(p, t[0] * v);
      return log6(relative(H, beam.interpolate(q.H1, q.H2, xi)));
    };
    CAPTURE(xi);
    CHECK(error(beam.interpolate_velocity(p.H1, p.H2, v.head<6>(), v.tail<6>(), xi), differences(motion, 1)) <
          1e-9);
  }
}

}  // namespace flexarm::tests::beam_test
