#include "flexarm/reduction/interface.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "flexarm/errors.hpp"
#include "reduction/parts.hpp"

namespace flexarm::tests::interface_test {

using Eigen::Vector3d;
using flexarm::InvalidParameter;
using namespace flexarm::reduction;

namespace {

Coordinates scattered(int n, unsigned seed) {
  Random random(seed);
  Coordinates points(n, 3);
  for (int k = 0; k < n; ++k) points.row(k) = random.vector(3, 0.2).transpose();
  return points;
}

Interface of_all(const Coordinates& points, InterfaceKind kind) {
  Interface interface{"bore", {0.3, -0.1, 0.05}};
  for (int k = 0; k < points.rows(); ++k) interface.points.push_back(k);
  interface.kind = kind;
  return interface;
}

std::string refusal(const std::vector<Interface>& interfaces, const Coordinates& points) {
  try {
    check(interfaces, points);
  } catch (const InvalidParameter& error) {
    return error.what();
  }
  return "taken";
}

}  // namespace

TEST_CASE("A rigid interface moves its points by t + r x (x - x0)") {
  const Coordinates points = scattered(4, 1);
  const Vector3d origin(0.3, -0.1, 0.05), t(0.1, 0.2, 0.3), r(-0.4, 0.5, 0.6);
  VectorXd q(6);
  q << t, r;
  const VectorXd u = rigid_motion(points, {3, 1}, origin) * q;
  const Vector3d arm = points.row(1).transpose() - origin;
  CHECK(error(u.tail(3), t + r.cross(arm)) < 1e-15);
}

TEST_CASE("The frame on average follows a rigid motion of its points exactly, wherever it lies") {
  const Coordinates points = scattered(7, 2);
  Interface interface = of_all(points, InterfaceKind::average);
  interface.weights = VectorXd::LinSpaced(7, 1, 9);
  const MatrixXd W = averaging(interface, points);
  CHECK(error(W * rigid_motion(points, interface.position), MatrixXd::Identity(6, 6)) < 1e-13);
}

TEST_CASE("The frame on average minimises the weighted distance from its points") {
  // The pseudo-inverse of the weighted least-squares problem, without normal equations.
  const Coordinates points = scattered(9, 3);
  Interface interface = of_all(points, InterfaceKind::average);
  interface.weights = VectorXd::LinSpaced(9, 0.2, 3);
  const MatrixXd expected = FullModel::least_squares_frame(interface, points);
  CHECK(relative_error(averaging(interface, points), expected) < 1e-13);
}

TEST_CASE("At the weighted mean the translation on average is the weighted mean of the translations") {
  const Coordinates points = scattered(5, 4);
  Interface interface = of_all(points, InterfaceKind::average);
  interface.weights = VectorXd::LinSpaced(5, 1, 2);
  const VectorXd w = interface.weights / interface.weights.sum();
  interface.position = points.transpose() * w;
  const MatrixXd W = averaging(interface, points);
  for (int k = 0; k < 5; ++k) {
    CHECK(error(W.block(0, 3 * k, 3, 3), w[k] * Eigen::Matrix3d::Identity()) < 1e-15);
  }
}

TEST_CASE("Weights count by their ratio alone, and equal ones may be left out") {
  const Coordinates points = scattered(6, 5);
  Interface interface = of_all(points, InterfaceKind::average);
  const MatrixXd W = averaging(interface, points);
  interface.weights = VectorXd::Constant(6, 3.7);
  CHECK(error(averaging(interface, points), W) < 1e-13);
}

TEST_CASE("Interfaces without six freedoms are refused by name and point") {
  Coordinates points = scattered(6, 6);
  points.topRows(4) << 0, 0, 0, 1, 1, 1, 2, 2, 2, 5, 5, 5;
  Interface good{"good", Vector3d::Zero()};
  good.points = {3, 4, 5};
  const auto with = [&](auto&& change) {
    Interface interface = good;
    interface.name = "bore";
    change(interface);
    return refusal({interface}, points);
  };
  CHECK(refusal({good}, points) == "taken");
  CHECK(with([](Interface& i) { i.points = {4, 5}; }) == "interface 'bore': needs at least 3 points, has 2");
  CHECK(with([](Interface& i) { i.points = {4, 5, 6}; }) ==
        "interface 'bore': there is no point 6, the part has 0 to 5");
  CHECK(with([](Interface& i) { i.points = {4, -1, 5}; }).find("no point -1") != std::string::npos);
  CHECK(with([](Interface& i) { i.points = {4, 5, 4}; }) == "interface 'bore': point 4 is listed twice");
  CHECK(with([](Interface& i) { i.points = {0, 1, 2, 3}; }).find("4 points lie on one line") !=
        std::string::npos);
  CHECK(with([](Interface& i) { i.weights = VectorXd::Ones(2); }) ==
        "interface 'bore': has 3 points and 2 weights");
  CHECK(with([](Interface& i) { i.weights = Vector3d(1, -3, 2); }).find("positive sum, got 0.000000") !=
        std::string::npos);
  CHECK(with([](Interface& i) { i.position.x() = NAN; }).find("position") != std::string::npos);
  CHECK(with([](Interface& i) { i.rotation(0, 0) = 1.1; }).find("rotation") != std::string::npos);
  CHECK(refusal({good, good}, points) == "interface 'good': the name is given twice");
}

TEST_CASE("A point follows one rigid interface only, but may be averaged as well") {
  const Coordinates points = scattered(6, 7);
  Interface a{"a", Vector3d::Zero()}, b{"b", Vector3d::Zero()};
  a.points = {0, 1, 2};
  b.points = {5, 2, 3};
  CHECK(refusal({a, b}, points) ==
        "interface 'b': point 2 also belongs to interface 'a'; a point may follow one rigid interface only");
  b.kind = InterfaceKind::average;
  CHECK(refusal({a, b}, points) == "taken");
}

}  // namespace flexarm::tests::interface_test
