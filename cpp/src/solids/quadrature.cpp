#include "flexarm/solids/quadrature.hpp"

#include <cmath>

namespace flexarm::solids {
namespace {

/// Product of a rule of n points on [−1, 1], ξ fastest.
template <int n>
Quadrature<n * n * n> product(const double (&points)[n], const double (&weights)[n]) {
  Quadrature<n * n * n> rule;
  for (int p = 0; p < rule.size; ++p) {
    const int i = p % n, j = p / n % n, k = p / (n * n);
    rule.points.col(p) << points[i], points[j], points[k];
    rule.weights[p] = weights[i] * weights[j] * weights[k];
  }
  return rule;
}

/// Points of barycentric coordinates (1 − 3a, a, a, a) and permutations, from column `first` on.
template <int n>
void add_corners(Quadrature<n>& rule, int first, double a, double weight) {
  rule.points.template middleCols<4>(first).setConstant(a);
  for (int axis = 0; axis < 3; ++axis) rule.points(axis, first + 1 + axis) = 1 - 3 * a;
  rule.weights.template segment<4>(first).setConstant(weight / 6);
}

/// Points of barycentric coordinates (b, b, ½ − b, ½ − b) and permutations.
template <int n>
void add_edges(Quadrature<n>& rule, int first, double b, double weight) {
  for (int axis = 0; axis < 3; ++axis) {
    rule.points.col(first + axis).setConstant(b);
    rule.points(axis, first + axis) = 0.5 - b;
    rule.points.col(first + 3 + axis).setConstant(0.5 - b);
    rule.points(axis, first + 3 + axis) = b;
  }
  rule.weights.template segment<6>(first).setConstant(weight / 6);
}

}  // namespace

const Quadrature<8>& gauss_2() {
  static const double x = 1 / std::sqrt(3.0);
  static const Quadrature<8> rule = product<2>({-x, x}, {1, 1});
  return rule;
}

const Quadrature<27>& gauss_3() {
  static const double x = std::sqrt(0.6);
  static const Quadrature<27> rule = product<3>({-x, 0, x}, {5.0 / 9, 8.0 / 9, 5.0 / 9});
  return rule;
}

const Quadrature<1>& tetrahedron_centre() {
  static const Quadrature<1> rule = {Eigen::Vector3d::Constant(0.25), Eigen::Matrix<double, 1, 1>(1.0 / 6)};
  return rule;
}

const Quadrature<4>& tetrahedron_4() {
  static const Quadrature<4> rule = [] {
    Quadrature<4> r;
    add_corners(r, 0, (5 - std::sqrt(5.0)) / 20, 0.25);
    return r;
  }();
  return rule;
}

const Quadrature<14>& tetrahedron_14() {
  static const Quadrature<14> rule = [] {
    Quadrature<14> r;
    add_corners(r, 0, 0.31088591926330060980, 0.11268792571801585080);
    add_corners(r, 4, 0.092735250310891226402, 0.073493043116361949544);
    add_edges(r, 8, 0.045503704125649649492, 0.042546020777081466438);
    return r;
  }();
  return rule;
}

}  // namespace flexarm::solids
