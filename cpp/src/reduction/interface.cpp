#include "flexarm/reduction/interface.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <map>

#include "flexarm/errors.hpp"

namespace flexarm::reduction {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Triplets = std::vector<Eigen::Triplet<double>>;

// Points whose scatter across a line is below this part of their scatter along it lie on that line.
constexpr double collinear = 1e-6;

Eigen::Matrix3d cross(const Vector3d& a) {
  Eigen::Matrix3d A;
  A << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return A;
}

Eigen::Matrix<double, 3, 6> motion_of(const Vector3d& arm) {
  Eigen::Matrix<double, 3, 6> A;
  A << Eigen::Matrix3d::Identity(), -cross(arm);
  return A;
}

[[noreturn]] void refuse(const Interface& interface, const std::string& what) {
  throw InvalidParameter("interface '" + interface.name + "': " + what);
}

VectorXd weights_of(const Interface& interface) {
  return interface.weights.size() > 0 ? interface.weights
                                      : VectorXd::Ones(static_cast<Index>(interface.points.size()));
}

/// Σ w d dᵀ about the weighted mean, with that mean.
struct Scatter {
  Vector3d mean = Vector3d::Zero();
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();

  Scatter(const Coordinates& coordinates, const std::vector<int>& points, const VectorXd& weights) {
    const VectorXd w = weights / weights.sum();
    const Coordinates x = coordinates(points, Eigen::all);
    mean = x.transpose() * w;
    const Coordinates d = x.rowwise() - mean.transpose();
    matrix = d.transpose() * w.asDiagonal() * d;
  }
  /// The second largest principal scatter vanishes against the largest.
  bool on_a_line() const {
    const Vector3d moments = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(matrix).eigenvalues();
    return !(moments[1] > collinear * collinear * moments[2]);
  }
};

void check_points(const Interface& interface, Index n_points) {
  if (interface.points.size() < 3) {
    refuse(interface, "needs at least 3 points, has " + std::to_string(interface.points.size()));
  }
  std::map<int, int> seen;
  for (const int k : interface.points) {
    if (k < 0 || k >= n_points) {
      refuse(interface, "there is no point " + std::to_string(k) + ", the part has 0 to " +
                            std::to_string(n_points - 1));
    }
    if (++seen[k] > 1) refuse(interface, "point " + std::to_string(k) + " is listed twice");
  }
}

void check_weights(const Interface& interface) {
  if (interface.weights.size() == 0) return;
  if (interface.weights.size() != static_cast<Index>(interface.points.size())) {
    refuse(interface, "has " + std::to_string(interface.points.size()) + " points and " +
                          std::to_string(interface.weights.size()) + " weights");
  }
  // Single ones may be negative: the corners of faces of second order pull back under an even pressure.
  const double sum = interface.weights.sum();
  if (!(sum > 0 && std::isfinite(sum))) {
    refuse(interface, "weights must be finite and have a positive sum, got " + std::to_string(sum));
  }
}

void check_frame(const Interface& interface) {
  const Eigen::Matrix3d& R = interface.rotation;
  if (!interface.position.allFinite()) refuse(interface, "its position is not finite");
  const double off = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off < 1e-9) || R.determinant() < 0) refuse(interface, "its rotation is not a rotation matrix");
}

}  // namespace

MatrixXd rigid_motion(const Coordinates& coordinates, const std::vector<int>& points,
                      const Vector3d& origin) {
  MatrixXd R(3 * static_cast<Index>(points.size()), 6);
  for (std::size_t k = 0; k < points.size(); ++k) {
    R.middleRows<3>(3 * static_cast<Index>(k)) =
        motion_of(coordinates.row(points[k]).transpose() - origin);  // eq. (1)
  }
  return R;
}

MatrixXd rigid_motion(const Coordinates& coordinates, const Vector3d& origin) {
  MatrixXd R(3 * coordinates.rows(), 6);
  for (Index k = 0; k < coordinates.rows(); ++k) {
    R.middleRows<3>(3 * k) = motion_of(coordinates.row(k).transpose() - origin);
  }
  return R;
}

bool on_a_line(const Coordinates& coordinates, const std::vector<int>& points) {
  return Scatter(coordinates, points, VectorXd::Ones(static_cast<Index>(points.size()))).on_a_line();
}

MatrixXd rigid_motion(const std::vector<Interface>& interfaces, const Vector3d& origin) {
  MatrixXd R = MatrixXd::Zero(6 * static_cast<Index>(interfaces.size()), 6);
  for (std::size_t k = 0; k < interfaces.size(); ++k) {
    R.middleRows<3>(6 * static_cast<Index>(k)) = motion_of(interfaces[k].position - origin);
    R.block<3, 3>(6 * static_cast<Index>(k) + 3, 3).setIdentity();
  }
  return R;
}

MatrixXd averaging(const Interface& interface, const Coordinates& coordinates) {
  // About the weighted mean translation and rotation do not mix; a length scale keeps them of one size.
  const Scatter scatter(coordinates, interface.points, weights_of(interface));
  const VectorXd w = weights_of(interface) / weights_of(interface).sum();
  const double length = std::sqrt(scatter.matrix.trace());
  MatrixXd A = rigid_motion(coordinates, interface.points, scatter.mean);
  A.rightCols<3>() /= length;
  const VectorXd w3 = w.replicate(1, 3).transpose().reshaped();
  const MatrixXd wA = w3.asDiagonal() * A;
  MatrixXd W = (A.transpose() * wA).ldlt().solve(wA.transpose());  // eq. (3)
  W.bottomRows<3>() /= length;
  W.topRows<3>() -=
      cross(interface.position - scatter.mean) * W.bottomRows<3>();  // t(x₀) = t + r × (x₀ − mean)
  return W;
}

void check(const std::vector<Interface>& interfaces, const Coordinates& coordinates) {
  std::map<std::string, int> names;
  std::map<int, const Interface*> owner;
  for (const Interface& interface : interfaces) {
    if (++names[interface.name] > 1) refuse(interface, "the name is given twice");
    check_points(interface, coordinates.rows());
    check_weights(interface);
    check_frame(interface);
    if (on_a_line(coordinates, interface.points)) {
      refuse(interface,
             "its " + std::to_string(interface.points.size()) +
                 " points lie on one line and cannot hold a frame; 3 that span a plane are needed");
    }
    if (interface.kind != InterfaceKind::rigid) continue;
    for (const int k : interface.points) {
      const auto [other, is_new] = owner.emplace(k, &interface);
      if (is_new) continue;
      refuse(interface, "point " + std::to_string(k) + " also belongs to interface '" + other->second->name +
                            "'; a point may follow one rigid interface only");
    }
  }
}

InterfaceMaps interface_maps(const std::vector<Interface>& interfaces, const Coordinates& coordinates) {
  const Index n = 3 * coordinates.rows();
  InterfaceMaps maps;
  maps.follows.assign(static_cast<std::size_t>(n), false);
  Triplets rigid, average;
  for (std::size_t i = 0; i < interfaces.size(); ++i) {
    const Interface& interface = interfaces[i];
    const int first = 6 * static_cast<int>(i),
              first_average = 6 * static_cast<int>(maps.average_columns.size());
    const bool is_rigid = interface.kind == InterfaceKind::rigid;
    const MatrixXd block = is_rigid ? rigid_motion(coordinates, interface.points, interface.position)
                                    : MatrixXd(averaging(interface, coordinates).transpose());
    for (Index row = 0; row < block.rows(); ++row) {
      const int freedom = 3 * interface.points[static_cast<std::size_t>(row / 3)] + static_cast<int>(row % 3);
      if (is_rigid) maps.follows[static_cast<std::size_t>(freedom)] = true;
      for (int c = 0; c < 6; ++c) {
        (is_rigid ? rigid : average)
            .emplace_back(freedom, (is_rigid ? first : first_average) + c, block(row, c));
      }
    }
    if (!is_rigid) maps.average_columns.push_back(first);
  }
  maps.rigid.resize(n, 6 * static_cast<Index>(interfaces.size()));
  maps.rigid.setFromTriplets(rigid.begin(), rigid.end());
  maps.average.resize(n, 6 * static_cast<Index>(maps.average_columns.size()));
  maps.average.setFromTriplets(average.begin(), average.end());
  return maps;
}

}  // namespace flexarm::reduction
