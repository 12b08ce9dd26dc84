/// Free vibration of solids against closed forms: waves in a box between smooth walls, Timoshenko's
/// cantilever.
#include <Eigen/LU>
#include <Eigen/SparseCholesky>

#include "blocks.hpp"

namespace flexarm::tests::modes_test {

namespace {

bool at(double value, double where) { return std::abs(value - where) < 1e-9; }

/// Lowest ω of K x = ω² M x on the freedoms that are not held, by inverse iteration.
double lowest_frequency(const SolidMesh& mesh, const std::vector<bool>& held, bool lump) {
  const SolidMatrices all = assemble(mesh, lump, 2);
  const SparseMatrix K = free_part(all.K, held), M = free_part(all.M, held);
  const Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower> factor(K);
  VectorXd x = Random(8).vector(K.rows());
  double omega_squared = 0, before = 1;
  for (int i = 0; i < 200 && std::abs(omega_squared / before - 1) > 1e-13; ++i) {
    before = omega_squared;
    x = factor.solve(times(M, x));
    x /= std::sqrt(x.dot(times(M, x)));
    omega_squared = x.dot(times(K, x));
  }
  return std::sqrt(omega_squared);
}

/// A box between smooth rigid walls: no normal displacement of its faces, no shear on them. Its modes are
/// standing waves with wave vectors π (i/a, j/b, l/c); the lowest here is the shear wave of (1, 1, 0), ω =
/// √(G/ρ) π √(1/a² + 1/b²). Returned is the relative error of ω.
double box_error(CellType type, int n, bool lump) {
  const Vector3d size(1, 0.8, 0.6);
  const SolidMesh mesh = mapped_box(type, {n, n, n}, scaled_to(size));
  const auto held =
      freedoms(mesh, [&](const Vector3d& x, int axis) { return at(x[axis], 0) || at(x[axis], size[axis]); });
  const double G = block_steel.youngs_modulus / (2 * (1 + block_steel.poisson_ratio));
  const double exact = std::sqrt(G / block_steel.density) * M_PI * std::hypot(1 / size[0], 1 / size[1]);
  return lowest_frequency(mesh, held, lump) / exact - 1;
}

/// First ω of Timoshenko's cantilever: with y = (w, ψ, M, Q), y' = A y and y(L) = exp(A L) y(0), clamped at 0
/// and free at L, the lower right block of exp(A L) must be singular.
double timoshenko_frequency(double EI, double GA, double rho_A, double rho_I, double L, double guess) {
  const auto determinant = [&](double omega) {
    // In multiples of L, EI/L and EI/L² the entries are near one.
    Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
    A(0, 1) = 1, A(0, 3) = EI / (GA * L * L);
    A(1, 2) = 1;
    A(2, 1) = -rho_I * omega * omega * L * L / EI, A(2, 3) = -1;
    A(3, 0) = -rho_A * omega * omega * std::pow(L, 4) / EI;
    Eigen::Matrix4d sum = Eigen::Matrix4d::Identity(), term = sum;
    for (int k = 1; k < 40; ++k) sum += term = term * A / k;
    return sum.bottomRightCorner<2, 2>().determinant();
  };
  double low = 0.9 * guess, high = 1.02 * guess;
  REQUIRE(determinant(low) * determinant(high) < 0);
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (determinant(low) * determinant(middle) > 0 ? low : high) = middle;
  }
  return low;
}

}  // namespace

TEST_CASE("Waves in a box converge from above: order 2 with straight cells, 4 with quadratic ones") {
  for (const CellType type : all_types) {
    const int n = type == CellType::tet4 ? 4 : 2;
    const double coarse = box_error(type, n, false), fine = box_error(type, 2 * n, false);
    CAPTURE(name(type));
    CHECK(observed_order(coarse, fine) > (is_quadratic(type) ? 3.3 : 1.5));
    CHECK(fine < (is_quadratic(type) ? 0.004 : 0.05));
    CHECK(fine > 0);  // the displacements of a mesh are among those of the body, so it is stiffer
  }
}

TEST_CASE("With lumped mass the waves come from below, at second order") {
  for (const CellType type : {CellType::hex8, CellType::hex20}) {
    const double coarse = box_error(type, 2, true), fine = box_error(type, 4, true);
    CAPTURE(name(type));
    CHECK(fine < 0);
    CHECK(observed_order(coarse, fine) == doctest::Approx(1.85).epsilon(0.05));
  }
}

TEST_CASE("A cantilever block has Timoshenko's first frequency") {
  // ν = 0, as the clamp would otherwise hold back Poisson's effect; κ is 5/6 then.
  const double L = 1, b = 0.08, h = 0.1, E = 210e9, G = E / 2, rho = 7850, A = b * h, I = h * b * b * b / 12;
  const double euler = 1.875104068711961 * 1.875104068711961 * std::sqrt(E * I / (rho * A)) / (L * L);
  const double exact = timoshenko_frequency(E * I, 5.0 / 6 * G * A, rho * A, rho * I, L, euler);
  CHECK(exact / euler == doctest::Approx(0.9958).epsilon(1e-4));  // shear and rotary inertia show
  const auto error = [&](CellType type, int n, bool lump) {
    const SolidMesh mesh = mapped_box(type, {10 * n, n, n}, scaled_to({L, b, h}), {E, 0, rho});
    const auto held = freedoms(mesh, [](const Vector3d& x, int) { return at(x[0], 0); });
    return lowest_frequency(mesh, held, lump) / exact - 1;
  };
  // At two cells over the height what is left is the difference between beam and solid, about 1e-4.
  CHECK(std::abs(error(CellType::hex20, 2, false)) < 1e-4);
  CHECK(std::abs(error(CellType::tet10, 2, false)) < 2e-4);
  CHECK(std::abs(error(CellType::hex8, 2, false)) < 1e-3);
  CHECK(std::abs(error(CellType::hex8, 2, true)) < 1e-3);
  CHECK(std::abs(error(CellType::hex20, 1, false)) < 1e-3);
  CHECK(std::abs(error(CellType::hex8, 1, false)) < 2e-3);
  CHECK(error(CellType::tet4, 2, false) > 0.3);  // locks
}

}  // namespace flexarm::tests::modes_test
