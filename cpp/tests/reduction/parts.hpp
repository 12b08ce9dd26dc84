/// @file
/// Parts to be reduced, small enough for dense algebra, and the same parts in full: the second formulation
/// that the reduction is checked against.
#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <numbers>

#include "flexarm/reduction/craig_bampton.hpp"
#include "flexarm/solids/assemble.hpp"
#include "numerics.hpp"

namespace flexarm::tests {

using reduction::Coordinates;
using reduction::Interface;
using reduction::InterfaceKind;
using SparseMatrix = Eigen::SparseMatrix<double>;

inline MatrixXd full(const SparseMatrix& A) { return MatrixXd(A).selfadjointView<Eigen::Lower>(); }

/// A steel block from the origin to (0.4, 0.1, 0.08) m of nx × ny × nz hexahedra.
struct Part {
  static constexpr double lx = 0.4, ly = 0.1, lz = 0.08, density = 7850;
  int nx, ny, nz;
  double last_layer = 1;  // its modulus of elasticity in parts of the others'
  Coordinates points;
  SparseMatrix K, M;

  explicit Part(int n_x = 5, int n_y = 2, int n_z = 2) : nx(n_x), ny(n_y), nz(n_z) {
    points.resize((nx + 1) * (ny + 1) * (nz + 1), 3);
    for (int i = 0; i <= nx; ++i)
      for (int j = 0; j <= ny; ++j)
        for (int k = 0; k <= nz; ++k) points.row(id(i, j, k)) << lx * i / nx, ly * j / ny, lz * k / nz;
    assemble();
  }

  int id(int i, int j, int k) const { return (i * (ny + 1) + j) * (nz + 1) + k; }

  void stiffen_last_layer(double factor) {
    last_layer = factor;
    assemble();
  }

  void assemble() {
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

  /// All points of the plane number i of nx + 1 across the block; its frame lies in the middle, moved by
  /// `off`.
  Interface plane(int i, InterfaceKind kind, const std::string& name,
                  const Eigen::Vector3d& off = Eigen::Vector3d::Zero()) const {
    Interface interface{name, Eigen::Vector3d(lx * i / nx, ly / 2, lz / 2) + off};
    for (int j = 0; j <= ny; ++j)
      for (int k = 0; k <= nz; ++k) interface.points.push_back(id(i, j, k));
    interface.kind = kind;
    return interface;
  }
  std::vector<Interface> ends(InterfaceKind first, InterfaceKind second) const {
    return {plane(0, first, "base"), plane(nx, second, "tip", {0.03, 0.01, -0.02})};
  }

  reduction::ReducedPart reduce(const std::vector<Interface>& interfaces, int modes) const {
    return reduction::reduce_part(K, M, points, interfaces, {.modes = modes});
  }
};

/// The part with its rigid interfaces written out: u = E x, x = (frames of rigid interfaces, other freedoms),
/// and its frames q = F x, average ones by least squares from (2) of interface.hpp.
struct FullModel {
  MatrixXd E, F, K, M;

  FullModel(const Part& part, const std::vector<Interface>& interfaces) {
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
        F.middleRows(6 * static_cast<Eigen::Index>(i), 6) =
            least_squares_frame(interfaces[i], part.points) * E;
      }
    }
    K = E.transpose() * full(part.K) * E;
    M = E.transpose() * full(part.M) * E;
  }

  static MatrixXd least_squares_frame(const Interface& interface, const Coordinates& points) {
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

  /// Frames and displacements under loads on the frames, the first interface held: the saddle point
  /// [K F₁ᵀ; F₁ 0] with the frames' loads spread by Fᵀ.
  struct Static {
    VectorXd q, u;
  };
  Static held_at_first(const VectorXd& load) const {
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

  /// ω² of the free part, rising.
  VectorXd free_spectrum() const {
    return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(K, M).eigenvalues();
  }

  /// ω² with all frames held: on the null space of F.
  VectorXd held_spectrum() const {
    const MatrixXd Z = F.fullPivLu().kernel();
    const MatrixXd Q =
        Eigen::HouseholderQR<MatrixXd>(Z).householderQ() * MatrixXd::Identity(Z.rows(), Z.cols());
    return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(Q.transpose() * K * Q, Q.transpose() * M * Q)
        .eigenvalues();
  }
};

inline VectorXd free_spectrum(const reduction::ReducedPart& reduced) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(reduced.stiffness, reduced.mass).eigenvalues();
}

inline VectorXd hertz(const VectorXd& omega_squared) {
  return omega_squared.cwiseMax(0.0).cwiseSqrt() / (2 * std::numbers::pi);
}

}  // namespace flexarm::tests
