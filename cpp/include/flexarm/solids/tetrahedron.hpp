/// @file
/// Tetrahedra of 4 and 10 nodes in barycentric coordinates L = (1 − ξ − η − ζ, ξ, η, ζ):
///
///     tet4    N_a = L_a                                                                                 (1)
///     tet10   N_a = L_a (2 L_a − 1) at corners, 4 L_a L_b in the middle of edge ab                       (2)
///
/// All integrals over straight cells are exact. With four points, enough for the stiffness of a straight
/// tet10, curved ones would miss the patch test; with those of degree 5 the forces of a constant stress,
/// polynomials of degree 3, are exact in them too. Four nodes carry one constant strain: tet4 is stiff in
/// bending and locks as ν → ½. Source: [ZienkiewiczTaylor].
#pragma once

#include "flexarm/solids/mesh.hpp"
#include "flexarm/solids/quadrature.hpp"

namespace flexarm::solids {

struct Tet4 {
  using Linear = Tet4;
  static constexpr CellType type = CellType::tet4;
  static constexpr int n_nodes = 4, n_modes = 0;
  using Values = Eigen::Matrix<double, n_nodes, 1>;
  using Gradients = Eigen::Matrix<double, 3, n_nodes>;  // column a: ∂N_a/∂ξ

  static Eigen::Vector3d node(int a);
  static Values values(const Eigen::Vector3d& xi);
  static Gradients gradients(const Eigen::Vector3d& xi);
  static const Quadrature<1>& stiffness_rule() { return tetrahedron_centre(); }
  static const Quadrature<4>& mass_rule() { return tetrahedron_4(); }
  static const Quadrature<4>& stress_rule() { return tetrahedron_4(); }
  /// det J over its largest value for cells with such edges, in [−1, 1]; 1 for the regular tetrahedron.
  /// [Verdict2007]
  static double scaled_jacobian(const Eigen::Matrix3d& J);
};

struct Tet10 {
  using Linear = Tet4;
  static constexpr CellType type = CellType::tet10;
  static constexpr int n_nodes = 10, n_modes = 0;
  using Values = Eigen::Matrix<double, n_nodes, 1>;
  using Gradients = Eigen::Matrix<double, 3, n_nodes>;

  static Eigen::Vector3d node(int a);
  static Values values(const Eigen::Vector3d& xi);
  static Gradients gradients(const Eigen::Vector3d& xi);
  static const Quadrature<14>& stiffness_rule() { return tetrahedron_14(); }
  static const Quadrature<14>& mass_rule() { return tetrahedron_14(); }
  static const Quadrature<4>& stress_rule() { return tetrahedron_4(); }
  static double scaled_jacobian(const Eigen::Matrix3d& J) { return Tet4::scaled_jacobian(J); }
};

}  // namespace flexarm::solids
