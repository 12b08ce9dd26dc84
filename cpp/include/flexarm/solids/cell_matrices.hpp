/// @file
/// Stiffness and mass of one cell.
///
/// With g_a = J⁻ᵀ ∂N_a/∂ξ the gradient of shape function a, integrals of products of two gradients hold
/// everything that an isotropic material needs:
///
///     G_ab = ∫ g_a g_bᵀ dV = Σ_p w_p det J_p g_a g_bᵀ                                                   (1)
///     K_ab = λ G_ab + μ G_abᵀ + μ tr(G_ab) I                                                            (2)
///     λ = E ν/((1 + ν)(1 − 2ν)),   μ = E/(2(1 + ν))
///
/// which is ∫ Bᵀ D B dV node by node. The incompatible modes of hex8 count as further nodes, with gradients
/// that the Jacobian J_0 of the cell's centre maps,
///
///     g_m = (det J_0/det J) J_0⁻ᵀ ∂N_m/∂ξ,   hence ∫ g_m dV = 0                                         (3)
///
/// so a state of constant strain does not excite them, however distorted the cell (patch test). Belonging to
/// one cell alone, their coordinates α follow from the nodes' displacements u and leave the stiffness before
/// assembly:
///
///     α = −K_αα⁻¹ K_αu u,    K = K_uu − K_uα K_αα⁻¹ K_αu                                                (4)
///
/// Mass, the same for the three axes, and its diagonal form, scaled to the mass of the cell:
///
///     m_ab = ∫ ρ N_a N_b dV                                                                             (5)
///     d_a = m_aa · Σ_bc m_bc / Σ_b m_bb                                                                 (6)
///
/// Sources: [ZienkiewiczTaylor]; (3), (4) [Wilson1973], [Taylor1976]; (6) [Hinton1976].
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "flexarm/solids/cell.hpp"

namespace flexarm::solids {

/// @throws InvalidParameter: the cell is inverted or flat.
[[noreturn]] void refuse_shape(const SolidMesh& mesh, std::size_t block, Eigen::Index cell,
                               double scaled_jacobian);

/// Lamé's constants [Pa].
struct Lame {
  explicit Lame(const SolidMaterial& m)
      : lambda(m.youngs_modulus * m.poisson_ratio / ((1 + m.poisson_ratio) * (1 - 2 * m.poisson_ratio))),
        mu(m.youngs_modulus / (2 * (1 + m.poisson_ratio))) {}
  double lambda, mu;
};

/// A cell whose det J anywhere is below this part of (size of the cell)³ counts as flat: rounding alone
/// leaves some 1e-16 of a cell without volume, and a sheet of 1 : 10⁴ still has 1e-4.
inline constexpr double flat_cell = 1e-10;

/// An inverted or flat cell, whose matrices do not exist.
struct BadShape {};

template <class Cell>
double smallest_determinant(const NodePositions<Cell>& X) {
  return flat_cell * std::pow(X.colwise().norm().maxCoeff(), 3);
}

/// Calls work(X, material) with the positions of a cell's nodes and its material.
/// @throws InvalidParameter that names the cell if its shape is bad.
template <class Cell, class Work>
auto with_positions(const SolidMesh& mesh, std::size_t block, Eigen::Index cell, Work&& work) {
  const CellBlock& cells = mesh.blocks()[block];
  const auto X = node_positions<Cell>(mesh.points(), cells.nodes.row(cell).data());
  try {
    return work(X, mesh.materials()[static_cast<std::size_t>(cells.material[cell])]);
  } catch (const BadShape&) {
    refuse_shape(mesh, block, cell, smallest_jacobian<Cell>(X));
  }
}

/// Gradients g_a at n points, incompatible modes behind the nodes, and volumes w_p det J_p.
template <class Cell, int n>
struct StrainPoints {
  static constexpr int n_functions = Cell::n_nodes + Cell::n_modes;
  Eigen::Matrix<double, 3, n_functions> gradients[n];
  Eigen::Matrix<double, n, 1> volumes;
};

/// Equation (3).
template <class Cell, int n>
void add_modes(const NodePositions<Cell>& X, const Quadrature<n>& rule, StrainPoints<Cell, n>& points) {
  const Eigen::Matrix3d J0 = jacobian<Cell>(X, Cell::gradients(Eigen::Vector3d::Zero()));
  const double det0 = J0.determinant();
  if (!(det0 > smallest_determinant<Cell>(X))) throw BadShape{};
  const Eigen::Matrix3d inverse0 = det0 * J0.inverse().transpose();
  for (int p = 0; p < n; ++p)
    points.gradients[p].template rightCols<Cell::n_modes>() =
        inverse0 * Cell::mode_gradients(rule.points.col(p)) * (rule.weights[p] / points.volumes[p]);
}

/// @throws BadShape
template <class Cell, int n>
StrainPoints<Cell, n> strain_points(const NodePositions<Cell>& X, const ShapeTable<Cell, n>& table) {
  StrainPoints<Cell, n> points;
  const double smallest = smallest_determinant<Cell>(X);
  for (int p = 0; p < n; ++p) {
    const Eigen::Matrix3d J = jacobian<Cell>(X, table.gradients[p]);
    const double det = J.determinant();
    if (!(det > smallest)) throw BadShape{};
    points.volumes[p] = table.rule.weights[p] * det;
    points.gradients[p].template leftCols<Cell::n_nodes>() =
        J.inverse().transpose().lazyProduct(table.gradients[p]);
  }
  if constexpr (Cell::n_modes > 0) add_modes<Cell>(X, table.rule, points);
  return points;
}

/// Stiffness before condensation: the nodes' freedoms 3a + axis, then those of the modes.
template <class Cell>
using FullStiffness =
    Eigen::Matrix<double, 3 * (Cell::n_nodes + Cell::n_modes), 3 * (Cell::n_nodes + Cell::n_modes)>;

/// Equations (1), (2); lower triangle.
template <class Cell, int n_points>
FullStiffness<Cell> full_stiffness(const StrainPoints<Cell, n_points>& points, const Lame& material) {
  constexpr int n = Cell::n_nodes + Cell::n_modes;
  Eigen::Matrix<double, 3 * n, n_points> g;
  for (int p = 0; p < n_points; ++p) g.col(p) = std::sqrt(points.volumes[p]) * points.gradients[p].reshaped();
  FullStiffness<Cell> K;
  K.noalias() = g * g.transpose();  // eq. (1)
  for (int b = 0; b < n; ++b) {
    for (int a = b; a < n; ++a) {
      auto block = K.template block<3, 3>(3 * a, 3 * b);
      const Eigen::Matrix3d G = block;
      block = material.lambda * G + material.mu * G.transpose();  // eq. (2)
      block.diagonal().array() += material.mu * G.trace();
    }
  }
  return K;
}

template <class Cell>
using Stiffness = Eigen::Matrix<double, 3 * Cell::n_nodes, 3 * Cell::n_nodes>;

/// Stiffness of a cell; lower triangle. @throws BadShape
template <class Cell>
Stiffness<Cell> stiffness(const NodePositions<Cell>& X, const Lame& material) {
  const FullStiffness<Cell> full =
      full_stiffness<Cell>(strain_points<Cell>(X, stiffness_table<Cell>()), material);
  if constexpr (Cell::n_modes == 0) {
    return full;
  } else {
    constexpr int n = 3 * Cell::n_nodes, m = 3 * Cell::n_modes;
    const Eigen::LLT<Eigen::Matrix<double, m, m>> factor(full.template bottomRightCorner<m, m>());
    const Eigen::Matrix<double, m, n> half = factor.matrixL().solve(full.template bottomLeftCorner<m, n>());
    Stiffness<Cell> K = full.template topLeftCorner<n, n>();
    K.noalias() -= half.transpose() * half;  // eq. (4)
    return K;
  }
}

template <class Cell>
using Mass = Eigen::Matrix<double, Cell::n_nodes, Cell::n_nodes>;

/// Equation (5). @throws BadShape
template <class Cell>
Mass<Cell> mass(const NodePositions<Cell>& X, double density) {
  const auto& table = mass_table<Cell>();
  const double smallest = smallest_determinant<Cell>(X);
  auto weighted = table.values;
  for (Eigen::Index p = 0; p < weighted.cols(); ++p) {
    const double det = jacobian<Cell>(X, table.gradients[p]).determinant();
    if (!(det > smallest)) throw BadShape{};
    weighted.col(p) *= density * table.rule.weights[p] * det;
  }
  return weighted * table.values.transpose();
}

/// Equation (6). A cell without density has none.
template <class Cell>
Eigen::Matrix<double, Cell::n_nodes, 1> lumped(const Mass<Cell>& m) {
  const double trace = m.trace();
  return trace > 0 ? (m.diagonal() * (m.sum() / trace)).eval() : m.diagonal().eval();
}

}  // namespace flexarm::solids
