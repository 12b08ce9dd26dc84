/// @file
/// Parts to be reduced, small enough for dense algebra, and the same parts in full: the second formulation
/// that the reduction is checked against.
#pragma once

#include <numbers>

#include "flexarm/reduction/craig_bampton.hpp"
#include "flexarm/solids/assemble.hpp"
#include "numerics.hpp"

namespace flexarm::tests {

using reduction::Coordinates;
using reduction::Interface;
using reduction::InterfaceKind;
using SparseMatrix = Eigen::SparseMatrix<double>;

MatrixXd full(const SparseMatrix& A);

/// A steel block from the origin to (0.4, 0.1, 0.08) m of nx × ny × nz hexahedra.
struct Part {
  static constexpr double lx = 0.4, ly = 0.1, lz = 0.08, density = 7850;
  int nx, ny, nz;
  double last_layer = 1;  // its modulus of elasticity in parts of the others'
  Coordinates points;
  SparseMatrix K, M;

  explicit Part(int n_x = 5, int n_y = 2, int n_z = 2);

  int id(int i, int j, int k) const { return (i * (ny + 1) + j) * (nz + 1) + k; }

  void stiffen_last_layer(double factor) {
    last_layer = factor;
    assemble();
  }

  void assemble();

  /// All points of the plane number i of nx + 1 across the block; its frame lies in the middle, moved by
  /// `off`.
  Interface plane(int i, InterfaceKind kind, const std::string& name,
                  const Eigen::Vector3d& off = Eigen::Vector3d::Zero()) const;
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

  FullModel(const Part& part, const std::vector<Interface>& interfaces);

  static MatrixXd least_squares_frame(const Interface& interface, const Coordinates& points);

  /// Frames and displacements under loads on the frames, the first interface held: the saddle point
  /// [K F₁ᵀ; F₁ 0] with the frames' loads spread by Fᵀ.
  struct Static {
    VectorXd q, u;
  };
  Static held_at_first(const VectorXd& load) const;

  /// ω² of the free part, rising.
  VectorXd free_spectrum() const;

  /// ω² with all frames held: on the null space of F.
  VectorXd held_spectrum() const;
};

VectorXd free_spectrum(const reduction::ReducedPart& reduced);

inline VectorXd hertz(const VectorXd& omega_squared) {
  return omega_squared.cwiseMax(0.0).cwiseSqrt() / (2 * std::numbers::pi);
}

}  // namespace flexarm::tests
