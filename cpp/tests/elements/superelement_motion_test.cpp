#include <doctest/doctest.h>

#include "parts.hpp"

namespace flexarm::tests::superelement_motion_test {

using flexarm::elements::SuperElement;
using flexarm::model::SuperElementLink;

namespace {

const Vector3d g{0.7, -1.1, -9.81};

/// As the reduction writes it: modes stand alone in K and C and are orthogonal in M, without rounding.
SuperElementLink with_modes_apart(SuperElementLink link) {
  const auto b = static_cast<Eigen::Index>(6 * link.frames.size());
  const Eigen::Index m = link.stiffness.rows() - b;
  for (MatrixXd* A : {&link.stiffness, &link.damping}) {
    if (A->size() == 0) continue;
    A->topRightCorner(b, m).setZero();
    A->bottomLeftCorner(m, b).setZero();
  }
  for (MatrixXd* A : {&link.stiffness, &link.damping, &link.mass}) {
    if (A->size() == 0) continue;
    const VectorXd diagonal = A->diagonal().tail(m);
    A->bottomRightCorner(m, m) = diagonal.asDiagonal();
  }
  link.mass = (0.5 * (link.mass + link.mass.transpose())).eval();
  return link;
}

/// Relative differences between the one pass and the separate ways: forces, and the four energies.
std::pair<double, double> compare(const SuperElementLink& link, unsigned seed) {
  Random random(seed);
  const SuperElement part(link, 0, 0);
  const Frame H = flexarm::geometry::exp6(random.twist(2, 2));
  SuperElement::Configuration at{{}, random.vector(part.n_modes(), 0.2)};
  for (const Frame& frame : link.frames) {
    at.frames.push_back(H * Frame::translation(frame.x) * flexarm::geometry::exp6(random.twist(0.1, 0.3)));
  }
  const VectorXd V = random.vector(part.size()), V_dot = random.vector(part.size());
  const auto forces = part.internal_forces(at, V, g);
  const VectorXd expected = forces.f + part.inertia_forces(V, V_dot);

  using View = Eigen::Map<const VectorXd>;
  const int b = 6 * part.n_interfaces(), m = part.n_modes();
  const SuperElement::Motion motion{at.frames.data(),      View(at.eta.data(), m), View(V.data(), b),
                                    View(V.data() + b, m), View(V_dot.data(), b),  View(V_dot.data() + b, m)};
  VectorXd r = VectorXd::Ones(part.size());  // what is there already stays
  part.add_forces(motion, g, r.head(b), r.tail(m));
  const auto E = part.energies(motion, g);
  const Eigen::Vector4d energies(E.kinetic, E.elastic, E.gravity, E.dissipation);
  const Eigen::Vector4d separate(0.5 * V.dot(part.momentum(V)), forces.elastic, forces.gravity,
                                 forces.dissipation);
  return {relative_error(VectorXd(r - VectorXd::Ones(part.size())), expected),
          ((energies - separate).array().abs() / (separate.array().abs() + 1e-9)).maxCoeff()};
}

}  // namespace

TEST_CASE("One pass over the state gives the forces and energies of the separate formulas") {
  const auto beam = thin_beam("beam", {0.8, 0.1, -0.2}, 1);
  SuperElementLink damped = with_modes_apart(reduced_beam(beam, 6, 4));
  damped.damping = 1e-3 * damped.stiffness;
  const std::vector<SuperElementLink> links{with_modes_apart(reduced_beam(beam, 6, 0)),  // of two interfaces
                                            with_modes_apart(reduced_beam(beam, 6, 4)), damped,
                                            with_modes_apart(tripod()),  // of three
                                            tripod()};                   // whose modes couple, by rounding
  unsigned seed = 1;
  for (const SuperElementLink& link : links) {
    CAPTURE(seed);
    const auto [of_forces, of_energies] = compare(link, seed++);
    CHECK(of_forces < 1e-13);
    CHECK(of_energies < 1e-12);
  }
}

TEST_CASE("Modes that couple to the interfaces in K act on them") {
  SuperElementLink link = with_modes_apart(reduced_beam(thin_beam("beam", {0.8, 0, 0}, 1), 6, 2));
  const double stiff = link.stiffness(6, 6);
  link.stiffness(6, 13) = link.stiffness(13, 6) = 0.3 * stiff;
  link.stiffness(0, 13) = link.stiffness(13, 0) = -0.3 * stiff;  // a rigid motion is not resisted
  CHECK(compare(link, 7).first < 1e-13);
}

}  // namespace flexarm::tests::superelement_motion_test
