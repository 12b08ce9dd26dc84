#include "flexarm/reduction/guyan.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "reduction/parts.hpp"

namespace flexarm::tests::guyan_test {

using flexarm::reduction::ReducedPart;

namespace {

constexpr auto rigid = InterfaceKind::rigid, average = InterfaceKind::average;

/// Frames under loads on the frames, the first one held, by the reduced stiffness.
VectorXd held_at_first(const MatrixXd& K, const VectorXd& load) {
  VectorXd q = VectorXd::Zero(K.rows());
  const Eigen::Index n = K.rows() - 6;
  q.tail(n) = MatrixXd(K.bottomRightCorner(n, n)).ldlt().solve(load.tail(n));
  return q;
}

}  // namespace

TEST_CASE("Statics are exact: frames and displacements of the full part under loads on its interfaces") {
  const Part part;
  for (const auto& [first, second] :
       {std::pair{rigid, rigid}, {rigid, average}, {average, rigid}, {average, average}}) {
    CAPTURE(static_cast<int>(first));
    CAPTURE(static_cast<int>(second));
    std::vector<Interface> interfaces = part.ends(first, second);
    interfaces[1].weights = VectorXd::LinSpaced(9, 1, 3);
    const ReducedPart reduced = part.reduce(interfaces, 0);
    VectorXd load = VectorXd::Zero(12);
    load.tail(6) << 1e5, -2e4, 3e4, 2e3, -4e3, 1e3;
    const FullModel::Static expected = FullModel(part, interfaces).held_at_first(load);
    const VectorXd q = held_at_first(reduced.stiffness, load);
    CHECK(relative_error(q, expected.q) < 1e-9);
    // With frames on average the load spreads over the points and moves them where no interface freedom
    // shows.
    if (first == rigid && second == rigid) CHECK(relative_error(reduced.recovery * q, expected.u) < 1e-9);
  }
}

TEST_CASE("Three interfaces of both kinds condense at once") {
  const Part part(4, 2, 2);
  const std::vector<Interface> interfaces = {part.plane(0, average, "a"), part.plane(2, average, "b"),
                                             part.plane(4, rigid, "c")};
  const ReducedPart reduced = part.reduce(interfaces, 0);
  const VectorXd load = Random(3).vector(18, 1e4);
  CHECK(relative_error(held_at_first(reduced.stiffness, load),
                       FullModel(part, interfaces).held_at_first(load).q) < 1e-9);
}

TEST_CASE("An interface on average may share points with a rigid one") {
  const Part part;
  Interface side{"side", Eigen::Vector3d(0.2, 0.05, 0)};
  for (int i = 0; i <= part.nx; ++i)
    for (int j = 0; j <= part.ny; ++j) side.points.push_back(part.id(i, j, 0));
  side.kind = average;
  const std::vector<Interface> interfaces = {part.plane(0, rigid, "base"), side};
  const VectorXd load = Random(4).vector(12, 1e4);
  const VectorXd q = held_at_first(part.reduce(interfaces, 0).stiffness, load);
  CHECK(relative_error(q, FullModel(part, interfaces).held_at_first(load).q) < 1e-9);
}

TEST_CASE("Rigid motion of the interfaces is free to the last digit") {
  const Part part;
  for (const auto& [first, second] : {std::pair{rigid, rigid}, {rigid, average}, {average, average}}) {
    const std::vector<Interface> interfaces = part.ends(first, second);
    const ReducedPart reduced = part.reduce(interfaces, 0);
    const MatrixXd R = flexarm::reduction::rigid_motion(interfaces, Eigen::Vector3d::Zero());
    const MatrixXd forces = reduced.stiffness * R;
    CHECK(largest(forces) < 1e-14 * largest(reduced.stiffness));
    CHECK(error(reduced.stiffness, reduced.stiffness.transpose()) == 0);
    CHECK(reduced.quality.rigid_body_correction < 1e-11);  // projection mends rounding, nothing else
    CHECK(relative_error(reduced.recovery * R,
                         flexarm::reduction::rigid_motion(part.points, Eigen::Vector3d::Zero())) < 1e-14);
  }
}

TEST_CASE("A part with one interface has no stiffness there, and its whole mass") {
  const Part part;
  for (const auto kind : {rigid, average}) {
    const ReducedPart reduced = part.reduce({part.plane(2, kind, "middle")}, 0);
    CHECK(largest(reduced.stiffness) < 1e-14 * largest(full(part.K)));
    CHECK(reduced.mass(0, 0) == near(reduced.quality.mass, 1e-12));
  }
}

TEST_CASE("A frame on average is never stiffer than a rigid one") {
  const Part part;
  const auto compliance = [&](InterfaceKind kind) -> MatrixXd {
    const MatrixXd K = part.reduce(part.ends(rigid, kind), 0).stiffness.bottomRightCorner(6, 6);
    return K.inverse();
  };
  const MatrixXd more = compliance(average) - compliance(rigid);
  const VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<MatrixXd>(more).eigenvalues();
  CHECK(eigenvalues.minCoeff() > -1e-12 * eigenvalues.maxCoeff());
  CHECK(eigenvalues.maxCoeff() > 1e-3 * compliance(rigid).norm());
}

TEST_CASE("Where the material is stiff around the interface, average and rigid are the same") {
  // The last layer of cells a million times stiffer: its points keep their places in the frame.
  Part part(4, 2, 2);
  part.stiffen_last_layer(1e6);
  const MatrixXd tied = part.reduce(part.ends(rigid, rigid), 0).stiffness;
  const MatrixXd averaged = part.reduce(part.ends(rigid, average), 0).stiffness;
  CHECK(relative_error(averaged, tied) < 1e-4);
  CHECK(relative_error(averaged, tied) > 0);
}

}  // namespace flexarm::tests::guyan_test
