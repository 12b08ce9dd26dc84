#include "flexarm/solids/hexahedron.hpp"

#include <Eigen/LU>

namespace flexarm::solids {
namespace {

using Eigen::Vector3d;

/// ξ_a of the nodes; a zero marks the middle of an edge along that axis.
constexpr double node_coordinates[20][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                            {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1},   // corners
                                            {0, -1, -1},  {1, 0, -1},  {0, 1, -1}, {-1, 0, -1},  // bottom
                                            {0, -1, 1},   {1, 0, 1},   {0, 1, 1},  {-1, 0, 1},   // top
                                            {-1, -1, 0},  {1, -1, 0},  {1, 1, 0},  {-1, 1, 0}};  // between

Vector3d place(int a) { return {node_coordinates[a][0], node_coordinates[a][1], node_coordinates[a][2]}; }

int middle_axis(int a) {
  for (int axis = 0; axis < 3; ++axis)
    if (node_coordinates[a][axis] == 0) return axis;
  return -1;
}

/// Gradient of f₀(ξ) f₁(η) f₂(ζ) from values and derivatives of the factors.
Vector3d product_gradient(const Vector3d& f, const Vector3d& df) {
  return {df[0] * f[1] * f[2], f[0] * df[1] * f[2], f[0] * f[1] * df[2]};
}

}  // namespace

Vector3d Hex8::node(int a) { return place(a); }

Hex8::Values Hex8::values(const Vector3d& xi) {
  Values N;
  for (int a = 0; a < n_nodes; ++a) N[a] = (1 + xi.array() * place(a).array()).prod() / 8;  // eq. (1)
  return N;
}

Hex8::Gradients Hex8::gradients(const Vector3d& xi) {
  Gradients g;
  for (int a = 0; a < n_nodes; ++a)
    g.col(a) = product_gradient(1 + xi.array() * place(a).array(), place(a)) / 8;
  return g;
}

double Hex8::scaled_jacobian(const Eigen::Matrix3d& J) {
  const double largest = J.col(0).norm() * J.col(1).norm() * J.col(2).norm();
  return largest > 0 ? J.determinant() / largest : 0;
}

Vector3d Hex20::node(int a) { return place(a); }

Hex20::Values Hex20::values(const Vector3d& xi) {
  Values N;
  for (int a = 0; a < n_nodes; ++a) {
    Vector3d f = 1 + xi.array() * place(a).array();
    const int axis = middle_axis(a);
    if (axis >= 0) {
      f[axis] = 1 - xi[axis] * xi[axis];
      N[a] = f.prod() / 4;  // eq. (2)
    } else {
      N[a] = f.prod() * (xi.dot(place(a)) - 2) / 8;  // eq. (2)
    }
  }
  return N;
}

Hex20::Gradients Hex20::gradients(const Vector3d& xi) {
  Gradients g;
  for (int a = 0; a < n_nodes; ++a) {
    Vector3d f = 1 + xi.array() * place(a).array(), df = place(a);
    const int axis = middle_axis(a);
    if (axis >= 0) {
      f[axis] = 1 - xi[axis] * xi[axis];
      df[axis] = -2 * xi[axis];
      g.col(a) = product_gradient(f, df) / 4;
    } else {
      g.col(a) = (product_gradient(f, df) * (xi.dot(place(a)) - 2) + f.prod() * place(a)) / 8;
    }
  }
  return g;
}

}  // namespace flexarm::solids
