#include "flexarm/assembly/iteration_matrix.hpp"

#include <doctest/doctest.h>

#include "arms.hpp"

namespace flexarm::tests::iteration_matrix_test {

using flexarm::assembly::IterationMatrix;
using flexarm::assembly::TangentFactors;

TEST_CASE("Numbers added into the known pattern give the tangent, in every new state") {
  flexarm::model::Arm arm = spatial_arm();
  arm.gears = {{"coupling", "turn", "lift", 3}};
  const System system(arm, {{"turn", DriveKind::motor_angle}, {"lift", DriveKind::free}});
  Loads loads;
  loads.points.push_back({.point = 0, .force = {1, 2, 3}, .moment = {1, 0, 2}});
  IterationMatrix matrix(system);
  for (unsigned seed : {1, 2, 3}) {
    const State state = random_state(system, seed);
    const TangentFactors c{100.0 * seed, 10, 1, 50};
    const auto kept = system.law_tangents(state, c, false);
    const MatrixXd fast = *matrix.assemble(state, loads, c, kept);
    const MatrixXd plain = system.tangent(state, loads, c);
    // Entry by entry, beside the largest of its row and column; below 1e-12 of these they are left out.
    const VectorXd beside = plain.cwiseAbs().rowwise().maxCoeff().cwiseSqrt();
    const MatrixXd scale = beside * beside.transpose();
    CHECK(largest((fast - plain).cwiseQuotient(scale)) < 2e-12);
  }
}

TEST_CASE("Friction enters the tangent with its present stiffness") {
  flexarm::model::Arm arm = two_link_arm();
  arm.joints[0].drive_train.bearing = {flexarm::joints::DahlFriction{4, 0.05}};
  const System system(arm, {{"shoulder", DriveKind::torque}, {"elbow", DriveKind::torque}});
  State state = random_state(system, 5);
  state.v.setZero();
  const int n = system.n_free();
  const auto f = [&](const VectorXd& dx) -> VectorXd {
    State there = state;
    flexarm::integrators::move(system, dx, there);
    VectorXd r(system.n_velocities());
    system.residual(there, Loads{}, true, r);
    return r.head(n);
  };
  IterationMatrix matrix(system);
  const TangentFactors c{0, 0, 1};
  const MatrixXd S = *matrix.assemble(state, Loads{}, c, system.law_tangents(state, c, true));
  const int scalars = n - system.scalar_offset();
  CHECK(relative_error(S.block(system.scalar_offset(), system.scalar_offset(), scalars, scalars),
                       differences(f, n, 1e-4).bottomRightCorner(scalars, scalars)) < 1e-9);
}

TEST_CASE(
    "A plane arm's matrix falls apart into motion in the plane and across it, and joins when it leaves") {
  const System system(paper_arm(), {{"hinge", DriveKind::motor_angle}});
  IterationMatrix matrix(system);
  const TangentFactors c{1e4, 100, 1, 1e4};
  const auto entries = [&](const State& state) {
    return matrix.assemble(state, Loads{}, c, VectorXd())->nonZeros();
  };
  const State straight = system.rigid_state({0.3});
  State in_plane = straight, bent = random_state(system, 7);
  bent.v.setZero();
  for (std::size_t n = 1; n < in_plane.frames.size(); ++n) {  // about the hinge's axis: section z
    in_plane.frames[n] = in_plane.frames[n] * Frame::rotation(flexarm::geometry::exp3({0, 0, 0.01}));
  }
  const auto plane = entries(in_plane), space = entries(bent);
  CHECK(plane < 0.7 * space);
  CHECK(entries(straight) == space);  // the pattern never shrinks
  const MatrixXd S = *matrix.assemble(straight, Loads{}, c, VectorXd());
  CHECK(relative_error(S, MatrixXd(system.tangent(straight, Loads{}, c))) < 1e-12);
}

TEST_CASE("Numbers that are not finite give no matrix and leave the pattern as it was") {
  const System system(paper_arm(), {{"hinge", DriveKind::motor_angle}});
  const State state = system.rigid_state({0.3});
  IterationMatrix matrix(system), fresh(system);
  const TangentFactors c{1e4, 100, 1, 1e4};
  CHECK(matrix.assemble(state, Loads{}, {HUGE_VAL, 100, 1, 1e4}, VectorXd()) == nullptr);
  CHECK(matrix.assemble(state, Loads{}, {std::nan(""), 100, 1, 1e4}, VectorXd()) == nullptr);
  IterationMatrix of_zeros(system);
  const auto* zeros = of_zeros.assemble(state, Loads{.gravity = Vector3d::Zero()}, {0, 0, 0, 0}, VectorXd());
  REQUIRE(zeros != nullptr);
  CHECK(zeros->rows() == system.n_unknowns());
  const auto* after = matrix.assemble(state, Loads{}, c, VectorXd());
  REQUIRE(after != nullptr);
  CHECK(after->nonZeros() == fresh.assemble(state, Loads{}, c, VectorXd())->nonZeros());
}

}  // namespace flexarm::tests::iteration_matrix_test
