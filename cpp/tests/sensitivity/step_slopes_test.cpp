#include "flexarm/sensitivity/step_slopes.hpp"

#include "arms.hpp"
#include "flexarm/assembly/planar_system.hpp"
#include "flexarm/sensitivity/beam_slopes.hpp"
#include "flexarm/simulation/statics.hpp"

namespace flexarm::tests::step_slopes_test {

using namespace flexarm;
using namespace flexarm::sensitivity;
using namespace flexarm::simulation;
using assembly::PlanarSystem;
using geometry::freedoms;
using geometry::Twist;
using geometry::TwistMatrix;

namespace {

Slopes rows(Random& random, Eigen::Index n, Eigen::Index m) {
  Slopes found(n, m);
  for (Eigen::Index k = 0; k < m; ++k) found.col(k) = random.vector(n);
  return found;
}

double difference(const Slopes& found, const Slopes& expected) {
  return (found - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
}

/// The equations of step_slopes.hpp with whole matrices, beside what StepSlopesIn makes of them.
template <int D>
void compare(const assembly::SystemIn<D>& system, const assembly::StateIn<D>& state,
             const assembly::LoadsIn<D>& loads, Eigen::Index m) {
  const auto coefficients = integrators::HhtCoefficients::from_alpha(-0.05);
  const auto [alpha, beta, gamma] = coefficients;
  const double h = 3e-3;
  const Eigen::Index n = system.n_free();
  Random random(static_cast<unsigned>(m));
  StateDerivative before(system, m), now = before;
  for (Slopes* part : {&before.position, &before.velocity, &before.v_dot, &before.a}) {
    *part = rows(random, part->rows(), m);
  }
  const VectorXd exponent = random.vector(n, 0.1);
  MatrixXd left = MatrixXd::Identity(n, n), right = left;  // T_l⁻¹, T_r⁻¹ of all nodes
  for (int k = 0; k < system.n_nodes(); ++k) {
    const Twist<D> h_k = exponent.segment<freedoms<D>>(freedoms<D> * k);
    const int at = freedoms<D> * k;
    left.block<freedoms<D>, freedoms<D>>(at, at) = geometry::left_tangent_inverse<D>(h_k);
    right.block<freedoms<D>, freedoms<D>>(at, at) = geometry::right_tangent_inverse<D>(h_k);
  }
  assembly::TangentPartsIn<D> parts(system);
  parts.assemble(state, loads, 2.0, true);
  const MatrixXd M = parts.M(), C = parts.C();

  const Slopes v0 = before.velocity.topRows(n), a0 = before.a.topRows(n), v_dot0 = before.v_dot.topRows(n);
  const Slopes a = -(left * before.position.topRows(n) + h * v0) / (beta * h * h) - (0.5 - beta) / beta * a0;
  const Slopes v = v0 + h * ((1 - gamma) * a0 + gamma * a), v_dot = (a + alpha * v_dot0) / (1 + alpha);
  const Slopes rhs = rows(random, system.n_unknowns(), m);
  Slopes expected = rhs;
  expected.topRows(n) -= C.topLeftCorner(n, n) * v + M.topLeftCorner(n, n) * v_dot;

  StepSlopesIn<D> step(system, coefficients);
  step.prepare(exponent, h);
  Slopes found = rhs;
  step.carry(before, parts, found);
  CHECK(difference(found, expected) < 1e-13);

  const Slopes xi = rows(random, system.n_unknowns(), m), turned = right * xi.topRows(n);
  step.update(xi, now);
  const double per_h2 = 1 / (beta * h * h);
  CHECK(difference(now.position.topRows(n), xi.topRows(n)) == 0);
  CHECK(difference(now.a.topRows(n), a + per_h2 * turned) < 1e-13);
  CHECK(difference(now.velocity.topRows(n), v + gamma * h * per_h2 * turned) < 1e-13);
  CHECK(difference(now.v_dot.topRows(n), v_dot + per_h2 / (1 + alpha) * turned) < 1e-13);

  Eigen::SparseMatrix<double> S;
  step.combine(parts, S);
  MatrixXd whole = parts.K();
  whole.leftCols(n) += (gamma * h * per_h2 * C.leftCols(n) + per_h2 / (1 + alpha) * M.leftCols(n)) * right;
  CHECK((MatrixXd(S) - whole).cwiseAbs().maxCoeff() < 1e-14 * whole.cwiseAbs().maxCoeff());
}

}  // namespace

TEST_CASE("The step of derivatives by vectors is the one of whole matrices, for every number of parameters") {
  const System space(spatial_arm(), {{"turn", DriveKind::free}});
  const State bent = random_state(space, 1);
  const System in_space(paper_arm({.hub_stiffness = 1e5, .damping_ratio = 0.02}),
                        {{"hinge", DriveKind::motor_angle}});
  const Equilibrium rest = static_equilibrium(in_space, {0.3}, {});
  const auto plane = PlanarSystem::about(in_space, rest.state, rest.loads);
  CAPTURE(plane.obstacle);
  REQUIRE(plane.system);
  auto moving = plane.system->part(rest.state);
  moving.v = Random(2).vector(moving.v.size());
  const auto loads = plane.system->part(rest.loads);
  for (const Eigen::Index m : {1, 2, 3, 7, 8, 20, 31}) {
    CAPTURE(m);
    compare<3>(space, bent, Loads{}, m);
    compare<2>(*plane.system, moving, loads, m);
  }
}

TEST_CASE("What a beam's parameters do to its forces by vectors is what matrices give one by one") {
  constexpr int n = freedoms<3>;
  Random random(3);
  const elements::TwoTwists<3> v = random.vector(2 * n), v_dot = random.vector(2 * n);
  const Vector6d e = random.vector(n), e_dot = random.vector(n);
  const Eigen::Matrix<double, 2 * n, n> to_ends = rows(random, 2 * n, n);
  for (const std::size_t count : {1, 5, 8, 13}) {
    const Eigen::Index m = filled_up(count);
    const StressSlopes stress{rows(random, n, m), rows(random, n, m), rows(random, n, m)};
    Slopes forces;
    stress_forces<3>(stress, e, e_dot, to_ends, forces);
    const Slopes sigma = stress.at_rest + MatrixXd(e.asDiagonal()) * stress.by_strain +
                         MatrixXd(e_dot.asDiagonal()) * stress.by_rate;
    CHECK(difference(forces, to_ends * sigma) < 1e-14);

    MassSlopes masses;
    for (int i = 0; i < 2 * n; ++i)
      for (int j = i % 2; j < 2 * n; j += 2) masses.entries.push_back({i, j});
    masses.mass = rows(random, static_cast<Eigen::Index>(masses.entries.size()), m);
    inertia_forces<3>(masses, v, v_dot, forces);
    Slopes expected(2 * n, m);
    for (Eigen::Index k = 0; k < m; ++k) {
      elements::TwoTwistsMatrix<3> M = elements::TwoTwistsMatrix<3>::Zero();
      for (std::size_t i = 0; i < masses.entries.size(); ++i) {
        M(masses.entries[i].row, masses.entries[i].column) = masses.mass(static_cast<Eigen::Index>(i), k);
      }
      elements::TwoTwists<3> f = M * v_dot;
      const elements::TwoTwists<3> momentum = M * v;
      for (int end : {0, n}) {
        f.segment<n>(end) -= geometry::ad<3>(v.segment<n>(end)).transpose() * momentum.segment<n>(end);
      }
      expected.col(k) = f;
    }
    CHECK(difference(forces, expected) < 1e-14);
  }
}

}  // namespace flexarm::tests::step_slopes_test
