#include "flexarm/solids/stress.hpp"

#include <Eigen/LU>
#include "blocks.hpp"
#include "flexarm/errors.hpp"
#include "flexarm/geometry/se3.hpp"

namespace flexarm::tests::stress_test {

namespace {

Points as_points(const VectorXd& u) { return u.reshaped(3, u.size() / 3).transpose(); }

}  // namespace

TEST_CASE("A constant strain has Hooke's stress at every point of a distorted mesh") {
  const Matrix3d gradient = (Matrix3d() << 1.0, 0.7, -0.4, 0.2, -0.6, 0.9, 0.5, -0.3, 0.8).finished() * 1e-3;
  const double E = block_steel.youngs_modulus, nu = block_steel.poisson_ratio, G = E / (2 * (1 + nu));
  // Hooke's law as textbooks print it: σ_x = E/((1+ν)(1−2ν)) ((1−ν) ε_x + ν (ε_y + ε_z)), τ = G γ.
  const Vector3d e = gradient.diagonal();
  Eigen::Matrix<double, 1, 6> expected;
  for (int i = 0; i < 3; ++i)
    expected[i] = E / ((1 + nu) * (1 - 2 * nu)) * ((1 - 2 * nu) * e[i] + nu * e.sum());
  expected[3] = G * (gradient(0, 1) + gradient(1, 0));
  expected[4] = G * (gradient(1, 2) + gradient(2, 1));
  expected[5] = G * (gradient(2, 0) + gradient(0, 2));
  for (const CellType type : all_types) {
    const SolidMesh mesh = distorted(mapped_box(type, {2, 2, 2}, scaled_to({0.3, 0.2, 0.1})), 0.004, 1);
    const Stresses found = stresses(mesh, mesh.points() * gradient.transpose());
    CAPTURE(name(type));
    CHECK(relative_error(found, expected.replicate(found.rows(), 1)) < 1e-12);
  }
}

TEST_CASE("In pure bending the stress is linear over the height, in the cells and at their corners") {
  // The bar bent by couples about y [TimoshenkoGoodier]: σ_x = −E κ z and no other stress.
  const double kappa = 0.01, nu = block_steel.poisson_ratio;
  const auto field = [&](const Vector3d& x) -> Vector3d {
    return kappa *
           Vector3d(-x[0] * x[2], nu * x[1] * x[2], (x[0] * x[0] + nu * (x[2] * x[2] - x[1] * x[1])) / 2);
  };
  for (const CellType type : {CellType::tet10, CellType::hex8, CellType::hex20}) {
    const SolidMesh mesh = mapped_box(type, {4, 2, 2}, [](const Vector3d& x) -> Vector3d {
      return Vector3d(x[0], 0.2 * x[1] - 0.1, 0.2 * x[2] - 0.1);
    });
    const Stresses s = stresses(mesh, as_points(at_points(mesh, field)));
    Stresses expected = Stresses::Zero(mesh.n_points(), 6);
    expected.col(0) = -block_steel.youngs_modulus * kappa * mesh.points().col(2);
    CAPTURE(name(type));
    CHECK(relative_error(s, expected) < 1e-11);
  }
}

TEST_CASE("Von Mises stress: the stress itself in tension, √3 τ in shear, none under pressure") {
  Stresses s(3, 6);
  s << 5, 0, 0, 0, 0, 0,  //
      0, 0, 0, 0, 2, 0,   //
      -7, -7, -7, 0, 0, 0;
  const VectorXd found = von_mises(s);
  CHECK(found[0] == near(5));
  CHECK(found[1] == near(2 * std::sqrt(3.0)));
  CHECK(found[2] == 0);
}

TEST_CASE("Von Mises stress is the same in every frame") {
  Random random(6);
  const Matrix3d A = random.vector(9).reshaped(3, 3), S = A + A.transpose();
  const Matrix3d R = flexarm::geometry::exp3(random.vector(3, 2)), T = R * S * R.transpose();
  const auto row = [](const Matrix3d& m) {
    return (Stresses(1, 6) << m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(1, 2), m(2, 0)).finished();
  };
  const Matrix3d deviator = S - S.trace() / 3 * Matrix3d::Identity();
  CHECK(von_mises(row(T))[0] == near(von_mises(row(S))[0]));
  CHECK(von_mises(row(S))[0] == near(std::sqrt(1.5) * deviator.norm()));  // √(3 J₂)
}

TEST_CASE("Displacements of another mesh are refused") {
  const SolidMesh mesh = mapped_box(CellType::hex8, {1, 1, 1}, scaled_to({1, 1, 1}));
  CHECK_THROWS_WITH_AS(stresses(mesh, Points::Zero(7, 3)),
                       "displacements: one row a point is needed, 8, got 7", flexarm::InvalidParameter);
}

TEST_CASE("Points of no cell have no stress") {
  const SolidMesh mesh = mapped_box(CellType::hex8, {1, 1, 1}, scaled_to({1, 1, 1}));
  Points points(9, 3);
  points << mesh.points(), Eigen::RowVector3d(5, 5, 5);
  const Stresses s = stresses(with_points(mesh, points), points);
  CHECK(s.row(0).norm() > 0);
  CHECK(s.row(8).norm() == 0);
}

}  // namespace flexarm::tests::stress_test
