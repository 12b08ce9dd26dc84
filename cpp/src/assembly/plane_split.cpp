#include "flexarm/assembly/plane_split.hpp"

#include "flexarm/dense.hpp"

namespace flexarm::assembly {

using namespace geometry;
using Eigen::MatrixXd;

Split::Split(const PlaneAxes& axes, int nodes, double length, const MatrixXd& kept,
             const MatrixXd& left_out) {
  const Eigen::Index m = kept.rows();
  within = MatrixXd::Zero(6 * nodes + m, 3 * nodes + kept.cols());
  across = MatrixXd::Zero(6 * nodes + m, 3 * nodes + left_out.cols());
  const Vector3d scale_within(1, 1, 1 / length), scale_across(1, 1 / length, 1 / length);
  for (int i = 0; i < nodes; ++i) {
    within.block<6, 3>(6 * i, 3 * i) = axes.within() * scale_within.asDiagonal();
    across.block<6, 3>(6 * i, 3 * i) = axes.across() * scale_across.asDiagonal();
  }
  within.bottomRightCorner(m, kept.cols()) = kept;
  across.bottomRightCorner(m, left_out.cols()) = left_out;
}

Split::Split(const PlaneAxes& axes, int nodes, double length)
    : Split(axes, nodes, length, MatrixXd(0, 0), MatrixXd(0, 0)) {}

double Split::coupling(const MatrixXd& A) const {
  const Eigen::ArrayXd p = (within.transpose() * A * within).diagonal();
  const Eigen::ArrayXd q = (across.transpose() * A * across).diagonal();
  const double translation = p.size() > 1 ? std::max({p[0], p[1], q[0]}) : 0.0;
  const Eigen::VectorXd scale_p = p.max(translation).sqrt(), scale_q = q.max(translation).sqrt();
  const Eigen::MatrixXd between = across.transpose() * A * within;
  return translation > 0 ? (between.array() / (scale_q * scale_p.transpose()).array()).abs().maxCoeff() : 0.0;
}

ModeSplit split_modes(const elements::SuperElement& part, const PlaneAxes& axes) {
  const int m = part.n_modes(), nodes = part.n_interfaces();
  if (m == 0) return {MatrixXd(0, 0), MatrixXd(0, 0)};
  const MatrixXd K = part.deformation_stiffness().bottomRightCorner(m, m);
  const MatrixXd M = part.mass().bottomRightCorner(m, m);
  const auto [omega_squared, vectors] = dense::eigenpairs(K, M);
  const MatrixXd shapes = std::sqrt(M(0, 0)) * vectors;  // unit columns where M is mass times I
  const Split split(axes, nodes, 1.0);
  const MatrixXd coupling = split.within.transpose() * part.mass().topRightCorner(6 * nodes, m) * shapes;
  const double largest_mass = part.mass().diagonal().maxCoeff();

  ModeSplit found{MatrixXd(m, 0), MatrixXd(m, 0)};
  const auto append = [](MatrixXd& to, const MatrixXd& columns) {
    const Eigen::Index before = to.cols();
    to.conservativeResize(Eigen::NoChange, before + columns.cols());
    to.rightCols(columns.cols()) = columns;
  };
  for (int first = 0, next; first < m; first = next) {
    for (next = first + 1; next < m && omega_squared[next] < (1 + 1e-6) * omega_squared[next - 1];) ++next;
    const int size = next - first;
    const auto turned = dense::right_singular(coupling.middleCols(first, size));
    const Eigen::Index moved = (turned.values.array() > reduced * largest_mass).count();
    const MatrixXd group = shapes.middleCols(first, size) * turned.vectors;
    append(found.kept, group.leftCols(moved));
    append(found.left_out, group.rightCols(size - moved));
  }
  return found;
}

}  // namespace flexarm::assembly
