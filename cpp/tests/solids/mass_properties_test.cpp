#include "flexarm/solids/mass_properties.hpp"

#include "blocks.hpp"
#include "flexarm/errors.hpp"

namespace flexarm::tests::mass_properties_test {

TEST_CASE("A box away from the origin has the moments of a box") {
  const Vector3d size(0.3, 0.2, 0.1), corner(5, -3, 2), c = corner + size / 2;
  const double m = block_steel.density * size.prod();
  const Matrix3d box = Vector3d(size[1] * size[1] + size[2] * size[2], size[0] * size[0] + size[2] * size[2],
                                size[0] * size[0] + size[1] * size[1])
                           .asDiagonal();
  const Matrix3d expected = m / 12 * box + m * (c.squaredNorm() * Matrix3d::Identity() - c * c.transpose());
  for (const CellType type : all_types) {
    const SolidMesh mesh = mapped_box(
        type, {3, 2, 2}, [&](const Vector3d& x) -> Vector3d { return corner + size.cwiseProduct(x); });
    const MassProperties found = mass_properties(mesh);
    CAPTURE(name(type));
    CHECK(found.mass == near(m));
    CHECK(relative_error(found.first_moment, m * c) < 1e-13);
    CHECK(relative_error(found.inertia, expected) < 1e-13);
  }
}

TEST_CASE("They are those of the consistent mass matrix, in curved cells too") {
  for (const CellType type : all_types) {
    const SolidMesh mesh = distorted(mapped_box(type, {2, 2, 2}, scaled_to({0.3, 0.2, 0.1})), 0.008, 7);
    const MatrixXd R = rigid_motions(mesh);
    const MatrixXd M = R.transpose() * dense(assemble(mesh, false, 1).M) * R;
    const MassProperties found = mass_properties(mesh);
    const Vector3d S = found.first_moment;
    const Matrix3d cross = (Matrix3d() << 0, -S[2], S[1], S[2], 0, -S[0], -S[1], S[0], 0).finished();
    CAPTURE(name(type));
    CHECK(M(0, 0) == near(found.mass));
    CHECK(relative_error(M.bottomLeftCorner<3, 3>(), cross) < 1e-12);
    CHECK(relative_error(M.bottomRightCorner<3, 3>(), found.inertia) < 1e-12);
  }
}

TEST_CASE("The mass of a quarter ring converges with the shape of its cells: order 2 straight, 4 quadratic") {
  const double exact = block_steel.density * M_PI / 4 * (0.2 * 0.2 - 0.1 * 0.1) * 0.1;
  const auto error = [&](CellType type, int n) {
    const SolidMesh mesh = mapped_box(type, {n, n, 1}, [](const Vector3d& x) -> Vector3d {
      const double r = 0.1 + 0.1 * x[0], angle = M_PI / 2 * x[1];
      return {r * std::cos(angle), r * std::sin(angle), 0.1 * x[2]};
    });
    return std::abs(mass_properties(mesh).mass - exact);
  };
  for (const CellType type : all_types) {
    CAPTURE(name(type));
    CHECK(observed_order(error(type, 4), error(type, 8)) ==
          doctest::Approx(is_quadratic(type) ? 4 : 2).epsilon(0.02));
  }
}

TEST_CASE("An inverted cell has no mass properties") {
  const SolidMesh mesh = mapped_box(CellType::tet4, {1, 1, 1}, scaled_to({-1, 1, 1}));
  CHECK_THROWS_WITH_AS(mass_properties(mesh), doctest::Contains("block 0 (tet4), cell 0 is inverted or flat"),
                       flexarm::InvalidParameter);
}

}  // namespace flexarm::tests::mass_properties_test
