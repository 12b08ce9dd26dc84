/// @file
/// Hexahedra of 8 and 20 nodes, ξ in [−1, 1]³, corners at ξ_a = ±1:
///
///     hex8    N_a = (1 + ξ ξ_a)(1 + η η_a)(1 + ζ ζ_a)/8                                                 (1)
///     hex20   N_a = (1 + ξ ξ_a)(1 + η η_a)(1 + ζ ζ_a)(ξ ξ_a + η η_a + ζ ζ_a − 2)/8 at corners,
///             N_a = (1 − ξ²)(1 + η η_a)(1 + ζ ζ_a)/4 where ξ_a = 0, and so for η and ζ                   (2)
///
/// hex8 also has the three incompatible modes 1 − ξ², 1 − η², 1 − ζ², three components each, that bend it
/// without shear (cell_matrices.hpp). Sources: [ZienkiewiczTaylor], [Taylor1976].
#pragma once

#include "flexarm/solids/mesh.hpp"
#include "flexarm/solids/quadrature.hpp"

namespace flexarm::solids {

struct Hex8 {
  using Linear = Hex8;
  static constexpr CellType type = CellType::hex8;
  static constexpr int n_nodes = 8, n_modes = 3;
  using Values = Eigen::Matrix<double, n_nodes, 1>;
  using Gradients = Eigen::Matrix<double, 3, n_nodes>;  // column a: ∂N_a/∂ξ

  static Eigen::Vector3d node(int a);
  static Values values(const Eigen::Vector3d& xi);
  static Gradients gradients(const Eigen::Vector3d& xi);
  /// Column m: ∂/∂ξ of mode 1 − ξ_m².
  static Eigen::Matrix3d mode_gradients(const Eigen::Vector3d& xi) { return (-2 * xi).asDiagonal(); }
  static const Quadrature<8>& stiffness_rule() { return gauss_2(); }
  static const Quadrature<27>& mass_rule() { return gauss_3(); }
  static const Quadrature<8>& stress_rule() { return gauss_2(); }
  /// det J over the product of the lengths of its columns, in [−1, 1]; 1 for every brick. [Verdict2007]
  static double scaled_jacobian(const Eigen::Matrix3d& J);
};

struct Hex20 {
  using Linear = Hex8;
  static constexpr CellType type = CellType::hex20;
  static constexpr int n_nodes = 20, n_modes = 0;
  using Values = Eigen::Matrix<double, n_nodes, 1>;
  using Gradients = Eigen::Matrix<double, 3, n_nodes>;

  static Eigen::Vector3d node(int a);
  static Values values(const Eigen::Vector3d& xi);
  static Gradients gradients(const Eigen::Vector3d& xi);
  static const Quadrature<27>& stiffness_rule() { return gauss_3(); }
  static const Quadrature<27>& mass_rule() { return gauss_3(); }
  static const Quadrature<8>& stress_rule() { return gauss_2(); }
  static double scaled_jacobian(const Eigen::Matrix3d& J) { return Hex8::scaled_jacobian(J); }
};

}  // namespace flexarm::solids
