/// Solids against closed forms of statics: bending, Lamé's ring, near incompressibility.
#include "blocks.hpp"
#include "flexarm/solids/stress.hpp"

namespace flexarm::tests::solids_statics_test {

namespace {

bool at(double value, double where) { return std::abs(value - where) < 1e-9; }

/// A bar of length L and square section h × h along x.
SolidMesh bar(CellType type, double L, double h, const Eigen::Vector3i& n,
              const SolidMaterial& material = block_steel) {
  return mapped_box(
      type, n, [=](const Vector3d& x) -> Vector3d { return {L * x[0], h * (x[1] - 0.5), h * (x[2] - 0.5)}; },
      material);
}

/// Tip deflection under a tip force P along z over that of Timoshenko's beam,
/// P L³/(3 E I) (1 + 3 E I/(κ G A L²)), with ν = 0: the clamped section then stays as the beam's, and κ =
/// 5/6.
double bending_ratio(CellType type, double L, double h, const Eigen::Vector3i& n) {
  const double E = 210e9, G = E / 2, P = 100, I = h * h * h * h / 12;
  const SolidMesh mesh = bar(type, L, h, n, {E, 0, 7850});
  const auto clamped = freedoms(mesh, [](const Vector3d& x, int) { return at(x[0], 0); });
  const auto tip = freedoms(mesh, [L](const Vector3d& x, int axis) { return at(x[0], L) && axis == 2; });
  // The force spreads evenly over the points of the tip; the tip's mean deflection is compared (St Venant).
  VectorXd load = VectorXd::Zero(mesh.n_dof());
  for (Eigen::Index i = 0; i < load.size(); ++i) load[i] = tip[static_cast<std::size_t>(i)];
  load /= load.sum();
  const VectorXd u = solve(assemble(mesh, false, 2).K, P * load, clamped, VectorXd::Zero(mesh.n_dof()));
  const double beam = P * L * L * L / (3 * E * I) * (1 + 3 * E * I / (5.0 / 6 * G * h * h * L * L));
  return load.dot(u) / beam;
}

/// A quarter of a long ring, inner radius 0.1, outer 0.2, in plane strain on a shaft that widens it by u_a.
/// Lamé: u_r = A r + B/r with σ_r = 0 outside, so B = A b²/(1 − 2ν), and A from u_r(a) = u_a.
struct Ring {
  static constexpr double a = 0.1, b = 0.2, u_a = 1e-5;
  SolidMaterial material;
  double A() const { return u_a / (a + b * b / (1 - 2 * material.poisson_ratio) / a); }
  double B() const { return A() * b * b / (1 - 2 * material.poisson_ratio); }
  double displacement(double r) const { return A() * r + B() / r; }
  double hoop(double r) const {
    const double E = material.youngs_modulus, nu = material.poisson_ratio;
    return E / (1 + nu) * (A() / (1 - 2 * nu) + B() / (r * r));
  }
  double radial(double r) const {
    return hoop(r) - 2 * material.youngs_modulus / (1 + material.poisson_ratio) * B() / (r * r);
  }

  SolidMesh mesh(CellType type, int n) const {
    return mapped_box(
        type, {n, n, 1},
        [](const Vector3d& x) -> Vector3d {
          const double r = a + (b - a) * x[0], angle = M_PI / 2 * x[1];
          return {r * std::cos(angle), r * std::sin(angle), 0.05 * x[2]};
        },
        material);
  }
  VectorXd solution(const SolidMesh& mesh) const {
    const auto held = freedoms(mesh, [](const Vector3d& x, int axis) {
      const bool symmetric = axis == 2 || at(x[axis], 0);
      return symmetric || at(x.head<2>().norm(), a);
    });
    const VectorXd exact = at_points(mesh, [&](const Vector3d& x) -> Vector3d {
      const double r = x.head<2>().norm();
      return displacement(r) / r * Vector3d(x[0], x[1], 0);
    });
    return solve(assemble(mesh, false, 2).K, VectorXd::Zero(mesh.n_dof()), held, exact);
  }
};

struct RingErrors {
  double displacement, energy, stress;
};

/// Largest error of the points' displacements over u_a, error of the energy and largest of the points' hoop
/// and radial stresses, all relative.
RingErrors ring_errors(CellType type, int n, double nu = 0.3) {
  const Ring ring{{210e9, nu, 7850}};
  const SolidMesh mesh = ring.mesh(type, n);
  const VectorXd u = ring.solution(mesh);
  const Stresses s = stresses(mesh, u.reshaped(3, mesh.n_points()).transpose());
  RingErrors e{};
  for (Eigen::Index i = 0; i < mesh.n_points(); ++i) {
    const Vector3d x = mesh.points().row(i).transpose();
    const double r = x.head<2>().norm(), c = x[0] / r, sn = x[1] / r;
    const Vector3d exact = ring.displacement(r) * Vector3d(c, sn, 0);
    e.displacement = std::max(e.displacement, (u.segment<3>(3 * i) - exact).norm() / Ring::u_a);
    const double hoop = s(i, 0) * sn * sn + s(i, 1) * c * c - 2 * s(i, 3) * sn * c;
    const double radial = s(i, 0) * c * c + s(i, 1) * sn * sn + 2 * s(i, 3) * sn * c;
    const double error = std::max(std::abs(hoop - ring.hoop(r)), std::abs(radial - ring.radial(r)));
    e.stress = std::max(e.stress, error / ring.hoop(Ring::a));
  }
  const double exact = -0.5 * ring.radial(Ring::a) * Ring::u_a * M_PI / 2 * Ring::a * 0.05;
  e.energy = std::abs(0.5 * u.dot(times(assemble(mesh, false, 1).K, u)) / exact - 1);
  return e;
}

}  // namespace

TEST_CASE("Slender bars bend without locking, except of tet4") {
  for (const CellType type : {CellType::tet10, CellType::hex8, CellType::hex20}) {
    CAPTURE(name(type));
    CHECK(bending_ratio(type, 10, 1, {10, 1, 1}) == near(1, 0.005));
    CHECK(bending_ratio(type, 100, 1, {10, 1, 1}) == near(1, 0.005));
    CHECK(bending_ratio(type, 10, 1, {20, 2, 2}) == near(1, 0.002));
  }
  // Constant strains: the shear of a bent cell counts as much as its bending, and more the longer the cell.
  CHECK(bending_ratio(CellType::tet4, 10, 1, {20, 2, 2}) == doctest::Approx(0.55).epsilon(0.02));
  CHECK(bending_ratio(CellType::tet4, 100, 1, {10, 1, 1}) < 0.01);
}

TEST_CASE("One layer of hex8 bends exactly under a couple") {
  const double L = 10, h = 1, M = 1000, I = 1.0 / 12;
  const SolidMesh mesh = bar(CellType::hex8, L, h, {5, 1, 1});
  const auto held = freedoms(mesh, [](const Vector3d& x, int axis) {
    const bool corner = x[1] < 0 && x[2] < 0;  // the section stays free to take Poisson's curvature
    return at(x[0], 0) && (axis == 0 || corner || (axis == 2 && x[2] < 0));
  });
  // Four forces at ±h/2 of M/2h each.
  const VectorXd load = at_points(mesh, [&](const Vector3d& x) -> Vector3d {
    return at(x[0], L) ? Vector3d(-M * x[2] / (h * h), 0, 0) : Vector3d::Zero();
  });
  const VectorXd u = solve(assemble(mesh, false, 1).K, load, held, VectorXd::Zero(mesh.n_dof()));
  const auto tip = freedoms(mesh, [&](const Vector3d& x, int axis) { return at(x[0], L) && axis == 2; });
  for (Eigen::Index i = 0; i < u.size(); ++i)
    if (tip[static_cast<std::size_t>(i)])
      CHECK(u[i] == near(M * L * L / (2 * block_steel.youngs_modulus * I), 1e-10));
}

TEST_CASE("Lamé's ring converges: order 2 straight; 4 in energy, 2.5 and more in displacement quadratic") {
  struct Expected {
    double displacement, energy, stress;  // orders; stresses of points are one-sided on the surface
  };
  const std::map<CellType, Expected> orders{{CellType::tet4, {1.3, 1.9, 0.75}},
                                            {CellType::tet10, {2.5, 3.8, 1.8}},
                                            {CellType::hex8, {1.95, 2.0, 0.95}},
                                            {CellType::hex20, {3.8, 3.6, 1.7}}};
  for (const auto& [type, order] : orders) {
    const RingErrors coarse = ring_errors(type, 4), fine = ring_errors(type, 8);
    CAPTURE(name(type));
    CHECK(observed_order(coarse.displacement, fine.displacement) > order.displacement);
    CHECK(observed_order(coarse.energy, fine.energy) > order.energy);
    CHECK(observed_order(coarse.stress, fine.stress) > order.stress);
    CHECK(fine.displacement < (type == CellType::tet4 ? 0.02 : 3e-4));
  }
}

TEST_CASE("A nearly incompressible ring keeps its stiffness, except of tet4") {
  for (const CellType type : {CellType::tet10, CellType::hex8, CellType::hex20}) {
    CAPTURE(name(type));
    CHECK(ring_errors(type, 8, 0.499).energy < 0.005);
  }
  CHECK(ring_errors(CellType::tet4, 8, 0.499).energy > 0.8);  // nearly twice too stiff
  CHECK(ring_errors(CellType::tet4, 8, 0.3).energy < 0.01);
}

}  // namespace flexarm::tests::solids_statics_test
