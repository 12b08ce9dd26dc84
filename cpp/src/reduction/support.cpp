#include "flexarm/reduction/support.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <sstream>

#include "flexarm/errors.hpp"

namespace flexarm::reduction {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using linear_solvers::LowerTriangle;

// Rows of (1) in parts of the diagonal: matrices written in single precision leave 1e-6.
constexpr double grounded_part = 1e-5;

void check_sizes(const LowerTriangle& K, const LowerTriangle& M, const Coordinates& coordinates) {
  const Index n = 3 * coordinates.rows();
  for (const auto& [matrix, name] : {std::pair{&K, "stiffness"}, {&M, "mass"}}) {
    if (matrix->rows() != n || matrix->cols() != n) {
      throw InvalidParameter(std::string(name) + " matrix: " + std::to_string(coordinates.rows()) +
                             " points need a size of " + std::to_string(n) + ", got " +
                             std::to_string(matrix->rows()) + " x " + std::to_string(matrix->cols()));
    }
    const Eigen::Map<const VectorXd> values(matrix->valuePtr(), matrix->nonZeros());
    if (!values.allFinite()) throw InvalidParameter(std::string(name) + " matrix: an entry is not finite");
  }
  if (!coordinates.allFinite()) throw InvalidParameter("coordinates: an entry is not finite");
}

/// Points that any entry of the matrix other than zero touches.
void mark_used(const LowerTriangle& A, std::vector<bool>& used) {
  for (Index j = 0; j < A.cols(); ++j)
    for (LowerTriangle::InnerIterator it(A, j); it; ++it) {
      if (it.value() == 0) continue;
      used[static_cast<std::size_t>(it.row() / 3)] = used[static_cast<std::size_t>(j / 3)] = true;
    }
}

void check_freedoms(const LowerTriangle& K, const std::vector<bool>& used, const Coordinates& coordinates) {
  const VectorXd stiffness = linear_solvers::diagonal(K);
  for (Index j = 0; j < stiffness.size(); ++j) {
    if (!used[static_cast<std::size_t>(j / 3)] || stiffness[j] > 0) continue;
    std::ostringstream message;
    message << name_of_freedom(coordinates, j) << ": nothing holds this freedom, its stiffness is "
            << stiffness[j] << " N/m";
    throw InvalidParameter(message.str());
  }
}

void check_interfaces_used(const std::vector<Interface>& interfaces, const std::vector<bool>& used,
                           const Coordinates& coordinates) {
  for (const Interface& interface : interfaces)
    for (const int k : interface.points) {
      if (used[static_cast<std::size_t>(k)]) continue;
      throw InvalidParameter("interface '" + interface.name + "': " + name_of_point(coordinates, k) +
                             " belongs to no element");
    }
}

/// Eq. (1), row by row.
void check_free(const LowerTriangle& K, const Coordinates& coordinates, const Support& support) {
  const VectorXd left =
      linear_solvers::multiply(K, scaled_rigid_motion(coordinates, support)).cwiseAbs().rowwise().maxCoeff();
  const VectorXd own = linear_solvers::diagonal(K);
  Index worst = 0;
  const double part = left.cwiseQuotient(own.cwiseMax(1e-300)).maxCoeff(&worst);
  if (part <= grounded_part) return;
  std::ostringstream message;
  message << name_of_freedom(coordinates, worst) << ": a rigid motion meets a force of " << left[worst]
          << " N/m there; a part to be reduced must be free, its supports are left to its interfaces";
  throw InvalidParameter(message.str());
}

/// Pieces of the part that no entry of K connects: the points of each.
std::vector<std::vector<int>> pieces(const LowerTriangle& K, const std::vector<bool>& used) {
  std::vector<int> parent(used.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int k) {
    while (parent[static_cast<std::size_t>(k)] != k) {
      auto& up = parent[static_cast<std::size_t>(k)];
      k = up = parent[static_cast<std::size_t>(up)];
    }
    return k;
  };
  for (Index j = 0; j < K.cols(); ++j)
    for (LowerTriangle::InnerIterator it(K, j); it; ++it) {
      if (it.value() == 0) continue;
      const int a = root(static_cast<int>(j / 3)), b = root(static_cast<int>(it.row() / 3));
      if (a != b) parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  std::map<int, std::vector<int>> by_root;
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (used[k]) by_root[root(static_cast<int>(k))].push_back(static_cast<int>(k));
  }
  std::vector<std::vector<int>> found;
  for (auto& [first, points] : by_root) found.push_back(std::move(points));
  return found;
}

/// Every piece needs three points of rigid interfaces off a line; a part of one piece may float.
void check_pieces(const std::vector<std::vector<int>>& all, const std::vector<Interface>& interfaces,
                  const Coordinates& coordinates, bool floating) {
  std::vector<bool> follows(static_cast<std::size_t>(coordinates.rows()), false);
  for (const Interface& interface : interfaces)
    for (const int k : interface.points) {
      if (interface.kind == InterfaceKind::rigid) follows[static_cast<std::size_t>(k)] = true;
    }
  if (floating && all.size() == 1) return;
  for (const std::vector<int>& piece : all) {
    std::vector<int> held;
    for (const int k : piece) {
      if (follows[static_cast<std::size_t>(k)]) held.push_back(k);
    }
    if (held.size() >= 3 && !on_a_line(coordinates, held)) continue;
    throw InvalidParameter("the part has " + std::to_string(all.size()) + " loose pieces, and the one with " +
                           name_of_point(coordinates, piece.front()) + ", " + std::to_string(piece.size()) +
                           " points, is held by " + std::to_string(held.size()) +
                           " points of rigid interfaces; 3 off a line are needed");
  }
}

/// The corners of a triangle as wide as the part, and of their nine freedoms the six that hold it best.
std::vector<int> isostatic_freedoms(const Coordinates& coordinates, const Support& support) {
  std::vector<int> used;
  for (Index k = 0; k < coordinates.rows(); ++k) {
    if (support.used[static_cast<std::size_t>(k)]) used.push_back(static_cast<int>(k));
  }
  const auto farthest = [&](const auto& distance) {
    return *std::max_element(used.begin(), used.end(),
                             [&](int a, int b) { return distance(a) < distance(b); });
  };
  const auto x = [&](int k) -> Vector3d { return coordinates.row(k).transpose(); };
  const int a = farthest([&](int k) { return (x(k) - support.centre).norm(); });
  const int b = farthest([&](int k) { return (x(k) - x(a)).norm(); });
  const int c = farthest([&](int k) { return (x(k) - x(a)).cross(x(b) - x(a)).norm(); });
  const std::vector<int> corners{a, b, c};
  MatrixXd R = rigid_motion(coordinates, corners, support.centre);
  R.rightCols<3>() /= support.length;
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(R.transpose());
  std::vector<int> freedoms;
  for (int k = 0; k < 6; ++k) {
    const int row = static_cast<int>(qr.colsPermutation().indices()[k]);
    freedoms.push_back(3 * corners[static_cast<std::size_t>(row / 3)] + row % 3);
  }
  return freedoms;
}

void measure(const Coordinates& coordinates, Support& support) {
  support.centre.setZero();
  Index n = 0;
  double squares = 0;
  for (Index k = 0; k < coordinates.rows(); ++k) {
    if (!support.used[static_cast<std::size_t>(k)]) continue;
    support.centre += coordinates.row(k).transpose();
    ++n;
  }
  support.centre /= static_cast<double>(n);
  for (Index k = 0; k < coordinates.rows(); ++k) {
    if (support.used[static_cast<std::size_t>(k)]) {
      squares += (coordinates.row(k).transpose() - support.centre).squaredNorm();
    }
  }
  support.length = std::sqrt(squares / static_cast<double>(n));
  support.unused_points = static_cast<int>(coordinates.rows() - n);
}

}  // namespace

MatrixXd scaled_rigid_motion(const Coordinates& coordinates, const Support& support) {
  MatrixXd R = rigid_motion(coordinates, support.centre);
  R.rightCols<3>() /= support.length;
  for (Index k = 0; k < coordinates.rows(); ++k) {
    if (!support.used[static_cast<std::size_t>(k)]) R.middleRows<3>(3 * k).setZero();
  }
  return R;
}

std::string name_of_point(const Coordinates& coordinates, Index point) {
  std::ostringstream name;
  name << "point " << point << " at (" << coordinates(point, 0) << ", " << coordinates(point, 1) << ", "
       << coordinates(point, 2) << ") m";
  return name.str();
}

std::string name_of_freedom(const Coordinates& coordinates, Index freedom) {
  return name_of_point(coordinates, freedom / 3) + ", direction " + "xyz"[freedom % 3];
}

Support support(const LowerTriangle& K, const LowerTriangle& M, const Coordinates& coordinates,
                const std::vector<Interface>& interfaces) {
  check_sizes(K, M, coordinates);
  if (interfaces.empty()) throw InvalidParameter("a part needs at least one interface");
  check(interfaces, coordinates);
  Support found;
  found.used.assign(static_cast<std::size_t>(coordinates.rows()), false);
  mark_used(K, found.used);
  mark_used(M, found.used);
  check_interfaces_used(interfaces, found.used, coordinates);
  check_freedoms(K, found.used, coordinates);
  measure(coordinates, found);
  check_free(K, coordinates, found);
  found.floating = std::none_of(interfaces.begin(), interfaces.end(),
                                [](const Interface& i) { return i.kind == InterfaceKind::rigid; });
  check_pieces(pieces(K, found.used), interfaces, coordinates, found.floating);
  if (found.floating) found.isostatic = isostatic_freedoms(coordinates, found);
  return found;
}

}  // namespace flexarm::reduction
