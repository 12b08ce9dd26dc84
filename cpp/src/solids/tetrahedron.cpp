#include "flexarm/solids/tetrahedron.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace flexarm::solids {
namespace {

constexpr int edges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

/// Barycentric coordinates.
Eigen::Vector4d barycentric(const Eigen::Vector3d& xi) { return {1 - xi.sum(), xi[0], xi[1], xi[2]}; }

}  // namespace

Eigen::Vector3d Tet4::node(int a) {
  if (a == 0) return Eigen::Vector3d::Zero();
  return Eigen::Vector3d::Unit(a - 1);
}

Tet4::Values Tet4::values(const Eigen::Vector3d& xi) { return barycentric(xi); }  // eq. (1)

Tet4::Gradients Tet4::gradients(const Eigen::Vector3d&) {
  Gradients g;
  g << Eigen::Vector3d::Constant(-1), Eigen::Matrix3d::Identity();
  return g;
}

/// The edges that meet in corner 0 are the columns of J; the others are their differences. Among cells with
/// given lengths of the three edges at each corner the regular one has the largest det J, their product over
/// √2.
double Tet4::scaled_jacobian(const Eigen::Matrix3d& J) {
  const double a = J.col(0).norm(), b = J.col(1).norm(), c = J.col(2).norm();
  const double ab = (J.col(1) - J.col(0)).norm(), bc = (J.col(2) - J.col(1)).norm(),
               ca = (J.col(0) - J.col(2)).norm();
  const double largest = std::max({a * b * c, a * ab * ca, b * ab * bc, c * bc * ca});
  return largest > 0 ? std::sqrt(2.0) * J.determinant() / largest : 0;
}

Eigen::Vector3d Tet10::node(int a) {
  if (a < 4) return Tet4::node(a);
  return (Tet4::node(edges[a - 4][0]) + Tet4::node(edges[a - 4][1])) / 2;
}

Tet10::Values Tet10::values(const Eigen::Vector3d& xi) {
  const Eigen::Vector4d L = barycentric(xi);
  Values N;
  for (int a = 0; a < 4; ++a) N[a] = L[a] * (2 * L[a] - 1);  // eq. (2)
  for (int e = 0; e < 6; ++e) N[4 + e] = 4 * L[edges[e][0]] * L[edges[e][1]];
  return N;
}

Tet10::Gradients Tet10::gradients(const Eigen::Vector3d& xi) {
  const Eigen::Vector4d L = barycentric(xi);
  const Tet4::Gradients dL = Tet4::gradients(xi);
  Gradients g;
  for (int a = 0; a < 4; ++a) g.col(a) = (4 * L[a] - 1) * dL.col(a);
  for (int e = 0; e < 6; ++e) {
    const int a = edges[e][0], b = edges[e][1];
    g.col(4 + e) = 4 * (L[a] * dL.col(b) + L[b] * dL.col(a));
  }
  return g;
}

}  // namespace flexarm::solids
