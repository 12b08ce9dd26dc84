/// The heavy top of Brüls, Cardona and Arnold (2012): m = 15 kg at (0, 1, 0) m from a fixed point, inertia
/// diag(0.234375, 0.46875, 0.234375) kg m² about the centre, 150 rad/s about its axis.
#include <doctest/doctest.h>

#include <array>

#include "arms.hpp"
#include "flexarm/integrators/hht.hpp"

namespace flexarm::tests::heavy_top_test {

using flexarm::geometry::exp3;
using flexarm::integrators::DriveValues;
using flexarm::integrators::HhtCoefficients;
using flexarm::integrators::HhtStepper;

namespace {

const Vector3d centre(0, 1, 0), weight(0, 0, -standard_gravity), spin(0, 150, -4.61538);
const Vector3d inertia(0.234375, 0.46875, 0.234375);
constexpr double mass = 15, duration = 0.1;

/// What is compared: where the centre is, the spin, and the force at the fixed point, both in body axes.
struct Top {
  Vector3d x, omega, force;
};

/// Euler's equations about the fixed point, by Runge and Kutta's method in steps of 2e-6 s.
Top reference() {
  const Vector3d J = inertia + mass * Vector3d(1, 0, 1);
  using Motion = std::pair<Vector3d, Eigen::Quaterniond>;
  const auto omega_dot = [&](const Vector3d& w, const Eigen::Quaterniond& q) -> Vector3d {
    const Vector3d moment = mass * centre.cross(q.conjugate() * weight) - w.cross(J.cwiseProduct(w));
    return moment.cwiseQuotient(J);
  };
  const auto rate = [&](const Motion& m) -> Motion {
    const Eigen::Quaterniond w(0, m.first.x(), m.first.y(), m.first.z());
    return {omega_dot(m.first, m.second), Eigen::Quaterniond(0.5 * (m.second * w).coeffs())};
  };
  const auto after = [](const Motion& m, const Motion& r, double h) -> Motion {
    return {m.first + h * r.first, Eigen::Quaterniond(m.second.coeffs() + h * r.second.coeffs())};
  };
  Motion m{spin, Eigen::Quaterniond::Identity()};
  const int n = 50000;
  const double h = duration / n;
  for (int k = 0; k < n; ++k) {
    const Motion k1 = rate(m), k2 = rate(after(m, k1, h / 2)), k3 = rate(after(m, k2, h / 2)),
                 k4 = rate(after(m, k3, h));
    m.first += h / 6 * (k1.first + 2 * k2.first + 2 * k3.first + k4.first);
    m.second.coeffs() +=
        h / 6 * (k1.second.coeffs() + 2 * k2.second.coeffs() + 2 * k3.second.coeffs() + k4.second.coeffs());
  }
  m.second.normalize();
  const Vector3d w = m.first, acceleration = omega_dot(w, m.second).cross(centre) + w.cross(w.cross(centre));
  return {m.second * centre, w, mass * (acceleration - m.second.conjugate() * weight)};
}

/// The top as a massless stick on a ball joint that carries the body at its end, so that the body's node is
/// its centre and every step has to keep the constraint.
flexarm::model::Arm heavy_top() {
  flexarm::model::Arm arm;
  arm.links = {flexarm::model::RigidLink{"stick"},
               flexarm::model::RigidLink{"body", mass, Vector3d::Zero(), inertia.asDiagonal()}};
  arm.joints = {{.name = "ball", .type = JointType::spherical, .child = "stick"},
                {.name = "weld",
                 .type = JointType::fixed,
                 .parent = "stick",
                 .child = "body",
                 .origin = Frame::translation(centre)}};
  return arm;
}

Top simulated(double h) {
  const System system(heavy_top(), {});
  const Loads loads{.gravity = weight};
  State state = system.rigid_state({0, 0});
  state.v << Vector3d::Zero(), spin, spin.cross(centre), spin;
  balance(system, loads, state);
  HhtStepper stepper(system, HhtCoefficients::from_alpha(-0.1), loads, {.tolerance = 1e-13});
  const auto n = static_cast<int>(std::lround(duration / h));
  for (int k = 0; k < n; ++k) stepper.advance(state, h, [](double, DriveValues&) {});
  return {state.frames[1].x, state.v.segment<3>(9), -state.multipliers.head<3>()};
}

}  // namespace

TEST_CASE("Heavy top: positions, velocities and multipliers converge at order two") {
  const Top exact = reference();
  std::vector<std::array<double, 3>> errors;
  for (double h : {4e-4, 2e-4, 1e-4}) {
    const Top top = simulated(h);
    errors.push_back(
        {(top.x - exact.x).norm(), (top.omega - exact.omega).norm(), (top.force - exact.force).norm()});
  }
  for (std::size_t quantity = 0; quantity < 3; ++quantity) {
    CAPTURE(quantity);
    CAPTURE(errors[2][quantity]);
    CHECK(observed_order(errors[0][quantity], errors[1][quantity]) == near(2, 0.1));
    CHECK(observed_order(errors[1][quantity], errors[2][quantity]) == near(2, 0.05));
  }
}

TEST_CASE("Heavy top: the body's centre stays on its sphere") {
  CHECK(simulated(4e-4).x.norm() == near(1, 1e-11));
}

}  // namespace flexarm::tests::heavy_top_test
