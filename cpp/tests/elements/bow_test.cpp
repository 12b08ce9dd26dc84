/// A bow: a strain that a beam has without stress, and that may grow.
#include <doctest/doctest.h>

#include "beams.hpp"
#include "flexarm/elements/beam.hpp"
#include "numerics.hpp"

namespace flexarm::tests::bow_test {

using namespace flexarm::geometry;
using flexarm::elements::BeamElement;

namespace {

constexpr double L = 0.8, tau = 5.0, eta = 0.03;
const Vector6d d0 = L * Vector6d::Unit(0);
const Vector6d b = (Vector6d() << 0.01, 0, 0, 0, 0.2, -0.3).finished() * L;

BeamElement bowed(double time) {
  BeamElement beam = straight_beam(L, plump, eta);
  beam.set_bow(b, time);
  return beam;
}

const Vector6d at_rest = Vector6d::Zero();

}  // namespace

TEST_CASE("A beam with a uniform curvature rests as an arc") {
  const BeamElement beam = bowed(0);
  const Frame H1 = exp6(Random(1).twist(2, 2)), H2 = H1 * exp6(d0 + b);
  const auto f = beam.internal_forces(H1, H2, at_rest, at_rest);
  CHECK(largest(f.f1) + largest(f.f2) < 1e-12);
  CHECK(f.energy < 1e-24);
  for (double xi : {0.0, 0.3, 0.8, 1.0}) {
    CHECK(largest(log6(relative(H1 * exp6(xi * (d0 + b)), beam.interpolate(H1, H2, xi)))) < 1e-14);
  }
}

TEST_CASE("A growing bow reaches 1 - exp(-t/tau) of its size, none at the start of the run") {
  const BeamElement beam = bowed(tau);
  for (double t : {0.0, 0.1, 5.0, 50.0}) {
    const Frame H2 = exp6(d0 + (1 - std::exp(-t / tau)) * b);
    CHECK(largest(beam.deformation(Frame{}, H2, t)) < 1e-14);
  }
}

TEST_CASE("The tangent of a bowed beam is the derivative of its forces") {
  const BeamElement beam = bowed(tau);
  const Frame H1 = exp6(Random(2).twist(2, 2)), H2 = H1 * exp6(d0 + 0.3 * b);
  const double t = 2.0;
  const auto f = [&](const VectorXd& h) -> VectorXd {
    VectorXd both(12);
    const auto out =
        beam.internal_forces(H1 * exp6(h.head<6>()), H2 * exp6(h.tail<6>()), at_rest, at_rest, t);
    both << out.f1, out.f2;
    return both;
  };
  CHECK(relative_error(beam.stiffness_matrix(H1, H2, Vector6d::Zero(), Vector6d::Zero(), t),
                       differences(f, 12)) < 1e-8);
}

TEST_CASE("What nodes and the growing bow give is stored or dissipated") {
  const BeamElement beam = bowed(tau);
  Random random(3);
  const Frame H1 = exp6(random.twist(2, 2)), H2 = H1 * exp6(d0 + random.twist(0.1, 0.2));
  const Vector6d v1 = random.twist(1, 1), v2 = random.twist(1, 1);
  const double t = 2.0;
  const auto out = beam.internal_forces(H1, H2, v1, v2, t);
  const auto energy_after = [&](double s) {
    return beam.internal_forces(H1 * exp6(s * v1), H2 * exp6(s * v2), at_rest, at_rest, t + s).energy;
  };
  CHECK(out.dissipation > 0);
  CHECK(std::abs(out.bow_power) > 1e-3);
  CHECK(out.f1.dot(v1) + out.f2.dot(v2) + out.bow_power ==
        near(derivative(energy_after, 0, 1e-4) + out.dissipation, 1e-8));
}

}  // namespace flexarm::tests::bow_test
