#include "flexarm/reduction/support.hpp"

#include <doctest/doctest.h>

#include <Eigen/SVD>

#include "flexarm/errors.hpp"
#include "reduction/parts.hpp"

namespace flexarm::tests::support_test {

using flexarm::InvalidParameter;
using flexarm::reduction::support;
using flexarm::reduction::Support;

namespace {

constexpr auto rigid = InterfaceKind::rigid, average = InterfaceKind::average;

std::string refusal(const Part& part, const std::vector<Interface>& interfaces) {
  try {
    support(part.K, part.M, part.points, interfaces);
  } catch (const InvalidParameter& error) {
    return error.what();
  }
  return "taken";
}

/// Two copies of a part, one metre apart.
Part twice(const Part& one) {
  Part both = one;
  const auto n = one.points.rows();
  both.points.resize(2 * n, 3);
  both.points << one.points, one.points;
  both.points.bottomRows(n).col(0).array() += 1;
  for (const auto& [single, pair] : {std::pair{&one.K, &both.K}, {&one.M, &both.M}}) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int j = 0; j < single->outerSize(); ++j)
      for (SparseMatrix::InnerIterator it(*single, j); it; ++it)
        for (const auto shift : {Eigen::Index{0}, 3 * n}) {
          entries.emplace_back(static_cast<int>(it.row() + shift), static_cast<int>(j + shift), it.value());
        }
    pair->resize(6 * n, 6 * n);
    pair->setFromTriplets(entries.begin(), entries.end());
  }
  return both;
}

}  // namespace

TEST_CASE("A free part in one piece is taken; without rigid interfaces it floats on six freedoms") {
  const Part part;
  CHECK_FALSE(support(part.K, part.M, part.points, part.ends(rigid, average)).floating);
  const Support floating = support(part.K, part.M, part.points, part.ends(average, average));
  REQUIRE(floating.floating);
  REQUIRE(floating.isostatic.size() == 6);
  // Holding them leaves no rigid motion, and as little as possible of any.
  const MatrixXd R = flexarm::reduction::rigid_motion(part.points, floating.centre);
  MatrixXd held(6, 6);
  for (int k = 0; k < 6; ++k) held.row(k) = R.row(floating.isostatic[static_cast<std::size_t>(k)]);
  held.rightCols(3) /= floating.length;
  CHECK(Eigen::JacobiSVD<MatrixXd>(held).singularValues()[5] > 0.1);
}

TEST_CASE("A grounded freedom is named") {
  Part part;
  part.K.coeffRef(3 * 7 + 2, 3 * 7 + 2) *= 1.01;
  CHECK(
      refusal(part, part.ends(rigid, rigid)).rfind("point 7 at (0, 0.1, 0.04) m, direction z: a rigid", 0) ==
      0);
}

TEST_CASE("A freedom without stiffness is named, a point without any is skipped") {
  SUBCASE("freedom") {
    Part part;
    const int loose = 3 * 20 + 1;
    for (int j = 0; j < part.K.outerSize(); ++j)
      for (SparseMatrix::InnerIterator it(part.K, j); it; ++it)
        if (it.row() == loose || j == loose) it.valueRef() = 0;
    CHECK(refusal(part, part.ends(rigid, rigid)).find("direction y: nothing holds this freedom") !=
          std::string::npos);
  }
  SUBCASE("point") {
    Part part;
    const auto n = part.points.rows();
    part.points.conservativeResize(n + 2, 3);
    part.points.bottomRows(2).setConstant(9);
    part.K.conservativeResize(3 * (n + 2), 3 * (n + 2));
    part.M.conservativeResize(3 * (n + 2), 3 * (n + 2));
    const Support found = support(part.K, part.M, part.points, part.ends(rigid, rigid));
    CHECK(found.unused_points == 2);
    CHECK(found.centre.x() == near(Part::lx / 2));  // left out of the size of the part too
    std::vector<Interface> interfaces = part.ends(rigid, rigid);
    interfaces[1].points.push_back(static_cast<int>(n));
    CHECK(refusal(part, interfaces).find("interface 'tip': point 54 at (9, 9, 9) m belongs to no element") ==
          0);
  }
}

TEST_CASE("A piece that no rigid interface holds is named") {
  const Part one(1, 2, 2), joined = twice(one);
  Interface near_end = one.plane(0, rigid, "near"), far_end = one.plane(1, rigid, "far");
  for (int& point : far_end.points) point += static_cast<int>(one.points.rows());
  CHECK(refusal(joined, {near_end, far_end}) == "taken");
  const std::string message = refusal(joined, {near_end});
  CHECK(message.find("2 loose pieces") != std::string::npos);
  CHECK(message.find("point 18 at (1, 0, 0) m, 18 points, is held by 0 points") != std::string::npos);
  far_end.kind = average;
  CHECK(refusal(joined, {near_end, far_end}).find("loose pieces") != std::string::npos);
}

TEST_CASE("Matrices of another size, or with entries that are no numbers, are refused") {
  Part part;
  const std::vector<Interface> interfaces = part.ends(rigid, rigid);
  CHECK(refusal(part, {}).find("at least one interface") != std::string::npos);
  SUBCASE("entry") {
    part.M.coeffRef(4, 4) = NAN;
    CHECK(refusal(part, interfaces) == "mass matrix: an entry is not finite");
  }
  SUBCASE("size") {
    part.K.conservativeResize(30, 30);
    CHECK(refusal(part, interfaces) == "stiffness matrix: 54 points need a size of 162, got 30 x 30");
  }
}

}  // namespace flexarm::tests::support_test
