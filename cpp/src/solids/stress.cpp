#include "flexarm/solids/stress.hpp"

#include "flexarm/dense.hpp"
#include "flexarm/errors.hpp"
#include "flexarm/solids/cell_matrices.hpp"

namespace flexarm::solids {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;

template <class Cell>
constexpr int n_samples = std::decay_t<decltype(Cell::stress_rule())>::size;

/// From values at the points of the stress rule to those at the nodes, by the (tri)linear function through
/// them.
template <class Cell>
const MatrixXd& extrapolation() {
  using Linear = typename Cell::Linear;
  static_assert(n_samples<Cell> == Linear::n_nodes);
  static const MatrixXd E = [] {
    MatrixXd at_nodes(Cell::n_nodes, n_samples<Cell>), at_samples(n_samples<Cell>, n_samples<Cell>);
    for (int a = 0; a < Cell::n_nodes; ++a) at_nodes.row(a) = Linear::values(Cell::node(a)).transpose();
    for (int p = 0; p < n_samples<Cell>; ++p)
      at_samples.row(p) = Linear::values(Cell::stress_rule().points.col(p)).transpose();
    return MatrixXd(at_nodes * dense::inverse(at_samples));
  }();
  return E;
}

/// Displacements of a cell's nodes, and behind them the coordinates α of its incompatible modes.
template <class Cell>
using Coordinates = Eigen::Matrix<double, 3, Cell::n_nodes + Cell::n_modes>;

template <class Cell>
Coordinates<Cell> coordinates(const NodePositions<Cell>& X, const NodePositions<Cell>& u,
                              const Lame& material) {
  Coordinates<Cell> all;
  all.template leftCols<Cell::n_nodes>() = u;
  if constexpr (Cell::n_modes > 0) {
    constexpr int n = 3 * Cell::n_nodes, m = 3 * Cell::n_modes;
    const FullStiffness<Cell> K =
        full_stiffness<Cell>(strain_points<Cell>(X, stiffness_table<Cell>()), material);
    const Eigen::LLT<Eigen::Matrix<double, m, m>> factor(K.template bottomRightCorner<m, m>());
    const Eigen::Matrix<double, m, 1> load = K.template bottomLeftCorner<m, n>() * u.reshaped();
    all.template rightCols<Cell::n_modes>() = -factor.solve(load).reshaped(3, Cell::n_modes);
  }
  return all;
}

/// Equation (1), as xx, yy, zz, xy, yz, zx.
Eigen::Matrix<double, 6, 1> stress(const Matrix3d& displacement_gradient, const Lame& material) {
  const Matrix3d strain = (displacement_gradient + displacement_gradient.transpose()) / 2;
  const Matrix3d s = material.lambda * strain.trace() * Matrix3d::Identity() + 2 * material.mu * strain;
  return (Eigen::Matrix<double, 6, 1>() << s.diagonal(), s(0, 1), s(1, 2), s(2, 0)).finished();
}

/// Stresses at a cell's nodes, one row each, and behind them the cell's volume.
template <class Cell>
Eigen::Matrix<double, Cell::n_nodes, 7> nodal_stresses(const NodePositions<Cell>& X,
                                                       const NodePositions<Cell>& u, const Lame& material) {
  const auto points = strain_points<Cell>(X, stress_table<Cell>());
  const Coordinates<Cell> q = coordinates<Cell>(X, u, material);
  MatrixXd sampled(n_samples<Cell>, 6);
  for (int p = 0; p < n_samples<Cell>; ++p)
    sampled.row(p) = stress(q * points.gradients[p].transpose(), material).transpose();
  Eigen::Matrix<double, Cell::n_nodes, 7> result;
  result.template leftCols<6>() = MatrixXd(extrapolation<Cell>() * sampled);
  result.col(6).setConstant(points.volumes.sum());
  return result;
}

/// Adds a cell's stresses times its volume, and its volume, to the rows of its points.
template <class Cell>
void add_cell(const SolidMesh& mesh, std::size_t block, Eigen::Index cell, const Points& displacements,
              Eigen::Matrix<double, Eigen::Dynamic, 7, Eigen::RowMajor>& sums) {
  const auto nodes = mesh.blocks()[block].nodes.row(cell);
  const auto values = with_positions<Cell>(mesh, block, cell,
                                           [&](const NodePositions<Cell>& X, const SolidMaterial& material) {
                                             NodePositions<Cell> u;
                                             for (int a = 0; a < Cell::n_nodes; ++a)
                                               u.col(a) = displacements.row(nodes[a]).transpose();
                                             return nodal_stresses<Cell>(X, u, Lame(material));
                                           });
  for (int a = 0; a < Cell::n_nodes; ++a) {
    sums.row(nodes[a]).template head<6>() += values(a, 6) * values.row(a).template head<6>();
    sums(nodes[a], 6) += values(a, 6);
  }
}

}  // namespace

Stresses stresses(const SolidMesh& mesh, const Points& displacements) {
  if (displacements.rows() != mesh.n_points())
    throw InvalidParameter("displacements: one row a point is needed, " + std::to_string(mesh.n_points()) +
                           ", got " + std::to_string(displacements.rows()));
  Eigen::Matrix<double, Eigen::Dynamic, 7, Eigen::RowMajor> sums(mesh.n_points(), 7);
  sums.setZero();
  for (std::size_t block = 0; block < mesh.blocks().size(); ++block)
    with_cell(mesh.blocks()[block].type, [&]<class Cell>(Cell) {
      for (Eigen::Index c = 0; c < mesh.blocks()[block].n_cells(); ++c)
        add_cell<Cell>(mesh, block, c, displacements, sums);
    });
  const Eigen::VectorXd volume = (sums.col(6).array() > 0).select(sums.col(6), 1);
  return volume.cwiseInverse().asDiagonal() * sums.leftCols<6>();
}

Eigen::VectorXd von_mises(const Stresses& stresses) {
  const auto s = stresses.array();
  const auto x = s.col(0), y = s.col(1), z = s.col(2);
  return (((x - y).square() + (y - z).square() + (z - x).square()) / 2 +
          3 * (s.col(3).square() + s.col(4).square() + s.col(5).square()))
      .sqrt();
}

}  // namespace flexarm::solids
