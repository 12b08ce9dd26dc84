#include "reduction/parts.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

namespace flexarm::tests {

MatrixXd full(const SparseMatrix& A) { return MatrixXd(A).selfadjointView<Eigen::Lower>(); }

Part::Part(int n_x, int n_y, int n_z) : nx(n_x), ny(n_y), nz(n_z) {
  points.resize((nx + 1) * (ny + 1) * (nz + 1), 3);
  for (int i = 0; i <= nx; ++i)
    for (int j = 0; j <= ny; ++j)
      for (int k = 0; k <= nz; ++k) points.row(id(i, j, k)) << lx * i / nx, ly * j / ny, lz * k / nz;
  assemble();
}

void Part::assemble() {
  solids::CellNodes nodes(nx * ny * nz, 8);
  int cell = 0;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k, ++cell) {
        nodes.row(cell) << id(i, j, k), id(i + 1, j, k), id(i + 1, j + 1, k), id(i, j + 1, k),
            id(i, j, k + 1), id(i + 1, j, k + 1), id(i + 1, j + 1, k + 1), id(i, j + 1, k + 1);
      }
  Eigen::VectorXi material = Eigen::VectorXi::Zero(nodes.rows());
  material.tail(ny * nz).setOnes();
  const solids::CellBlock block{solids::CellType::hex8, nodes, material};
  const double E = 210e9;
  auto [stiffness, mass] =
      solids::assemble({points, {block}, {{E, 0.3, density}, {last_layer * E, 0.3, density}}}, false, 1);
  K = stiffness;
  M = mass;
}

Interface Part::plane(int i, InterfaceKind kind, const std::string& name, const Eigen::Vector3d& off) const {
  Interface interface{name, Eigen::Vector3d(lx * i / nx, ly / 2, lz / 2) + off};
  for (int j = 0; j <= ny; ++j)
    for (int k = 0; k <= nz; ++k) interface.points.push_back(id(i, j, k));
  interface.kind = kind;
  return interface;
}

FullModel::FullModel(const Part& part, const std::vector<Interface>& interfaces) {
  const reduction::InterfaceMaps maps = reduction::interface_maps(interfaces, part.points);
  const Eigen::Index n = part.K.rows(), n_frames = maps.rigid.cols();
  const MatrixXd B = maps.rigid;
  std::vector<Eigen::Index> frames, inner;
  for (Eigen::Index c = 0; c < n_frames; ++c)
    if (B.col(c).norm() > 0) frames.push_back(c);
  for (Eigen::Index j = 0; j < n; ++j)
    if (!maps.follows[static_cast<std::size_t>(j)]) inner.push_back(j);
  const auto n_rigid = static_cast<Eigen::Index>(frames.size()),
             n_inner = static_cast<Eigen::Index>(inner.size());
  E = MatrixXd::Zero(n, n_rigid + n_inner);
  E.leftCols(n_rigid) = B(Eigen::all, frames);
  for (Eigen::Index k = 0; k < n_inner; ++k) E(inner[static_cast<std::size_t>(k)], n_rigid + k) = 1;
  F = MatrixXd::Zero(n_frames, E.cols());
  for (Eigen::Index k = 0; k < n_rigid; ++k) F(frames[static_cast<std::size_t>(k)], k) = 1;
  for (std::size_t i = 0; i < interfaces.size(); ++i) {
    if (interfaces[i].kind == InterfaceKind::average) {
      F.middleRows(6 * static_cast<Eigen::Index>(i), 6) = least_squares_frame(interfaces[i], part.points) * E;
    }
  }
  K = E.transpose() * full(part.K) * E;
  M = E.transpose() * full(part.M) * E;
}

MatrixXd FullModel::least_squares_frame(const Interface& interface, const Coordinates& points) {
  const MatrixXd A = reduction::rigid_motion(points, interface.points, interface.position);
  VectorXd root = VectorXd::Ones(A.rows());
  for (Eigen::Index k = 0; k < A.rows(); ++k) {
    if (interface.weights.size() > 0) root[k] = std::sqrt(interface.weights[k / 3]);
  }
  const MatrixXd pick = (root.asDiagonal() * A).completeOrthogonalDecomposition().pseudoInverse();
  MatrixXd W = MatrixXd::Zero(6, 3 * points.rows());
  for (Eigen::Index k = 0; k < A.rows(); ++k) {
    W.col(3 * interface.points[static_cast<std::size_t>(k / 3)] + k % 3) = pick.col(k) * root[k];
  }
  return W;
}

FullModel::Static FullModel::held_at_first(const VectorXd& load) const {
  const Eigen::Index n = K.rows();
  MatrixXd A = MatrixXd::Zero(n + 6, n + 6);
  const double scale = K.norm();  // keeps the two blocks of one size
  A.topLeftCorner(n, n) = K;
  A.topRightCorner(n, 6) = scale * F.topRows(6).transpose();
  A.bottomLeftCorner(6, n) = scale * F.topRows(6);
  VectorXd b = VectorXd::Zero(n + 6);
  b.head(n) = F.transpose() * load;
  const VectorXd x = A.fullPivLu().solve(b).head(n);
  return {F * x, E * x};
}

VectorXd FullModel::free_spectrum() const {
  return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(K, M).eigenvalues();
}

VectorXd FullModel::held_spectrum() const {
  const MatrixXd Z = F.fullPivLu().kernel();
  const MatrixXd Q =
      Eigen::HouseholderQR<MatrixXd>(Z).householderQ() * MatrixXd::Identity(Z.rows(), Z.cols());
  return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(Q.transpose() * K * Q, Q.transpose() * M * Q)
      .eigenvalues();
}

VectorXd free_spectrum(const reduction::ReducedPart& reduced) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(reduced.stiffness, reduced.mass).eigenvalues();
}

}  // namespace flexarm::tests
