/// @file
/// Interfaces: node sets of a part tied to a frame of six freedoms, q = (t, r) about the part's axes.
///
///     rigid      u_k = t + r × (x_k − x₀)                                    every node follows the frame
///     (1) average    Σ w_k |u_k − t − r × (x_k − x₀)|² → min                     the frame follows the nodes
///     (2)
///                q = W u,   W = (Aᵀ w A)⁻¹ Aᵀ w,   A_k = [1  −(x_k − x₀)~] (3)
///
/// (1) stiffens the part, (2) leaves it as it is and spreads the load over the nodes by their weights: RBE2
/// and RBE3 of Nastran. Units: m, rad.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <string>
#include <vector>

namespace flexarm::reduction {

enum class InterfaceKind { rigid, average };

struct Interface {
  std::string name;
  Eigen::Vector3d position;                                ///< x₀ in the part's frame
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< of its axes; no freedom depends on it
  std::vector<int> points{};                               ///< rows of the coordinates
  InterfaceKind kind = InterfaceKind::rigid;
  Eigen::VectorXd weights{};  ///< w of (2), one a point; empty: equal
};

using Coordinates = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;  ///< one point a row [m]

/// Displacement of `points` by the motions (t, r) of a frame at `origin`: three rows a point, eq. (1).
Eigen::MatrixXd rigid_motion(const Coordinates& coordinates, const std::vector<int>& points,
                             const Eigen::Vector3d& origin);
/// The same for all points.
Eigen::MatrixXd rigid_motion(const Coordinates& coordinates, const Eigen::Vector3d& origin);

/// The six freedoms of every interface when the part moves rigidly by (t, r) about `origin`.
Eigen::MatrixXd rigid_motion(const std::vector<Interface>& interfaces, const Eigen::Vector3d& origin);

/// Whether no three of the points span a plane.
bool on_a_line(const Coordinates& coordinates, const std::vector<int>& points);

/// W of eq. (3): six rows, three columns a point.
Eigen::MatrixXd averaging(const Interface& interface, const Coordinates& coordinates);

/// Refuses what has no six freedoms: points that do not exist, repeat, lie on one line, or that two rigid
/// interfaces claim; frames and weights that are none. @throws InvalidParameter naming interface and point.
void check(const std::vector<Interface>& interfaces, const Coordinates& coordinates);

/// The interfaces as maps on all freedoms, three a point; columns six an interface.
struct InterfaceMaps {
  Eigen::SparseMatrix<double>
      rigid;  ///< (n, 6 interfaces): displacement of the rigid ones' nodes; average: 0
  Eigen::SparseMatrix<double> average;  ///< (n, 6 average interfaces): Wᵀ
  std::vector<bool> follows;            ///< (n): the freedom follows a rigid interface
  std::vector<int> average_columns;     ///< where the first of six of each average interface lies in `rigid`
};
InterfaceMaps interface_maps(const std::vector<Interface>& interfaces, const Coordinates& coordinates);

}  // namespace flexarm::reduction
