#include "flexarm/reduction/craig_bampton.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "flexarm/errors.hpp"
#include "reduction/parts.hpp"

namespace flexarm::tests::craig_bampton_test {

using Eigen::Vector3d;
using flexarm::InvalidParameter;
using flexarm::reduction::ReducedPart;

namespace {

constexpr auto rigid = InterfaceKind::rigid, average = InterfaceKind::average;
const std::vector<std::pair<InterfaceKind, InterfaceKind>> kinds = {
    {rigid, rigid}, {rigid, average}, {average, average}};

std::string refusal(const Part& part, const std::vector<Interface>& interfaces,
                    const flexarm::reduction::ReductionOptions& options = {}) {
  try {
    flexarm::reduction::reduce_part(part.K, part.M, part.points, interfaces, options);
  } catch (const InvalidParameter& error) {
    return error.what();
  }
  return "taken";
}

}  // namespace

TEST_CASE("Frequencies with held interfaces are those of the full part") {
  const Part part;
  for (const auto& [first, second] : kinds) {
    const std::vector<Interface> interfaces = part.ends(first, second);
    const VectorXd expected = hertz(FullModel(part, interfaces).held_spectrum());
    const ReducedPart reduced = part.reduce(interfaces, 8);
    REQUIRE(reduced.frequency_hz.size() == 8);
    CHECK(relative_error(reduced.frequency_hz, expected.head(8)) < 1e-9);
    CHECK(reduced.quality.left_out_frequency_hz == near(expected[8], 1e-2));
    CHECK(reduced.quality.mode_residual.maxCoeff() < 1e-6);
  }
}

TEST_CASE("Modes up to a frequency are all modes up to it") {
  const Part part;
  const std::vector<Interface> interfaces = part.ends(rigid, rigid);
  const VectorXd expected = hertz(FullModel(part, interfaces).held_spectrum());
  const double limit = 0.5 * (expected[10] + expected[11]);
  const ReducedPart reduced =
      flexarm::reduction::reduce_part(part.K, part.M, part.points, interfaces, {.max_frequency = limit});
  CHECK(reduced.frequency_hz.size() == 11);
  CHECK(reduced.quality.left_out_frequency_hz > limit);
}

TEST_CASE("Free frequencies lie above the full part's and fall towards them as modes are added") {
  const Part part;
  for (const auto& [first, second] : kinds) {
    CAPTURE(static_cast<int>(second));
    const std::vector<Interface> interfaces = part.ends(first, second);
    const VectorXd exact = FullModel(part, interfaces).free_spectrum();
    VectorXd before = VectorXd::Constant(6, INFINITY);
    for (const int modes : {0, 2, 5, 10, 20, 40}) {
      const VectorXd found = free_spectrum(part.reduce(interfaces, modes)).segment(6, 6);
      const VectorXd room = 1e-9 * exact.segment(6, 6);  // rounding
      CHECK(((found - exact.segment(6, 6) + room).array() > 0).all());
      CHECK(((before - found + room).array() > 0).all());
      before = found;
    }
    CHECK(relative_error(before.head(3), exact.segment(6, 3)) < 1e-3);
  }
}

TEST_CASE("With all its modes the reduced part is the full part") {
  const Part part(2, 1, 2);
  for (const auto& [first, second] : kinds) {
    const std::vector<Interface> interfaces = part.ends(first, second);
    const VectorXd exact = FullModel(part, interfaces).free_spectrum();
    const ReducedPart reduced = part.reduce(interfaces, 1000);
    const VectorXd found = free_spectrum(reduced);
    REQUIRE(found.size() == exact.size());
    CHECK(relative_error(found, exact) < 1e-9);
    CHECK(reduced.quality.left_out_frequency_hz == INFINITY);
  }
}

TEST_CASE("Mass, first moment and inertia of the reduced part are the block's") {
  const Part part;
  const double m = Part::density * Part::lx * Part::ly * Part::lz;
  const Vector3d c(Part::lx / 2, Part::ly / 2, Part::lz / 2), size(Part::lx, Part::ly, Part::lz);
  // About the origin: m/12 (|s|² 1 − s sᵀ, its diagonal) + m (|c|² 1 − c cᵀ).
  const MatrixXd own = m / 12 * (size.squaredNorm() * Vector3d::Ones() - size.cwiseAbs2()).asDiagonal();
  const MatrixXd inertia = own + m * (c.squaredNorm() * Eigen::Matrix3d::Identity() - c * c.transpose());
  Eigen::Matrix3d cross;
  cross << 0, -c.z(), c.y(), c.z(), 0, -c.x(), -c.y(), c.x(), 0;
  for (const auto& [first, second] : kinds) {
    const std::vector<Interface> interfaces = part.ends(first, second);
    const ReducedPart reduced = part.reduce(interfaces, 4);
    MatrixXd R = MatrixXd::Zero(16, 6);
    R.topRows(12) = flexarm::reduction::rigid_motion(interfaces, Vector3d::Zero());
    const MatrixXd block = R.transpose() * reduced.mass * R;
    CHECK(error(block.topLeftCorner(3, 3), m * MatrixXd::Identity(3, 3)) < 1e-12 * m);
    CHECK(error(block.topRightCorner(3, 3), -m * cross) < 1e-12 * m);
    CHECK(error(block.bottomRightCorner(3, 3), inertia) < 1e-12 * m);
    CHECK(reduced.quality.mass == near(m, 1e-12));
    CHECK(error(reduced.quality.centre, c) < 1e-12);
    CHECK(error(reduced.quality.inertia, own) < 1e-12 * m);
  }
}

TEST_CASE("The inertia load is the part's mass times a unit acceleration") {
  const Part part;
  for (const auto& [first, second] : kinds) {
    const std::vector<Interface> interfaces = part.ends(first, second);
    const ReducedPart reduced = part.reduce(interfaces, 6);
    const MatrixXd translation = flexarm::reduction::rigid_motion(part.points, Vector3d::Zero()).leftCols(3);
    const MatrixXd expected = reduced.recovery.transpose() * (full(part.M) * translation);
    CHECK(relative_error(reduced.inertia_load, expected) < 1e-12);
  }
}

TEST_CASE("Reduced matrices are the full ones in the recovered shapes") {
  const Part part;
  for (const auto& [first, second] : kinds) {
    const ReducedPart reduced = part.reduce(part.ends(first, second), 6);
    const MatrixXd& T = reduced.recovery;
    CHECK(relative_error(reduced.stiffness, T.transpose() * full(part.K) * T) < 1e-9);
    CHECK(relative_error(reduced.mass, T.transpose() * full(part.M) * T) < 1e-12);
    CHECK(error(reduced.mass.bottomRightCorner(6, 6), MatrixXd::Identity(6, 6)) == 0);
    CHECK(largest(reduced.stiffness.topRightCorner(12, 6)) == 0);
  }
}

TEST_CASE("Points recovered from a rigid interface follow its frame; averages of points are their frame") {
  const Part part;
  const std::vector<Interface> interfaces = part.ends(rigid, average);
  const ReducedPart reduced = part.reduce(interfaces, 3);
  const VectorXd u = reduced.recovery * Random(5).vector(15);
  const VectorXd q = Random(5).vector(15);
  const VectorXd expected =
      flexarm::reduction::rigid_motion(part.points, interfaces[0].points, interfaces[0].position) * q.head(6);
  for (std::size_t k = 0; k < interfaces[0].points.size(); ++k) {
    CHECK(error(u.segment(3 * interfaces[0].points[k], 3),
                expected.segment(3 * static_cast<Eigen::Index>(k), 3)) < 1e-12);
  }
  CHECK(error(FullModel::least_squares_frame(interfaces[1], part.points) * u, q.segment(6, 6)) < 1e-11);
}

TEST_CASE("In another frame the part reduces to the same matrices, turned") {
  const Part part;
  const Eigen::Matrix3d Q = Eigen::AngleAxisd(0.7, Vector3d(1, -2, 3).normalized()).matrix();
  const Vector3d shift(3, -1, 2);
  Part moved = part;
  moved.points = (part.points * Q.transpose()).rowwise() + shift.transpose();
  moved.assemble();
  for (const auto& [first, second] : kinds) {
    std::vector<Interface> interfaces = part.ends(first, second), turned = interfaces;
    for (Interface& interface : turned) interface.position = Q * interface.position + shift;
    const ReducedPart a = part.reduce(interfaces, 5), b = moved.reduce(turned, 5);
    MatrixXd D = MatrixXd::Identity(17, 17);
    for (int k = 0; k < 12; k += 3) D.block(k, k, 3, 3) = Q;
    // Modes are determined up to their sign.
    for (int k = 12; k < 17; ++k) {
      const VectorXd row = D.topLeftCorner(12, 12) * a.mass.col(k).head(12);
      if (row.dot(b.mass.col(k).head(12)) < 0) D(k, k) = -1;
    }
    CHECK(relative_error(b.stiffness, D * a.stiffness * D.transpose()) < 1e-9);
    CHECK(relative_error(b.mass, D * a.mass * D.transpose()) < 1e-6);  // shapes to the tolerance of Lanczos
    CHECK(relative_error(b.frequency_hz, a.frequency_hz) < 1e-10);
    CHECK(relative_error(b.inertia_load, D * a.inertia_load * Q.transpose()) < 1e-6);
  }
}

TEST_CASE("In millimetres, tonnes and newtons the part reduces to the same matrices, scaled") {
  const Part part;
  Part small = part;
  small.points *= 1000;
  small.K *= 1e-3;  // N/mm
  small.M *= 1e-3;  // t
  for (const auto& [first, second] : kinds) {
    std::vector<Interface> interfaces = part.ends(first, second), scaled = interfaces;
    for (Interface& interface : scaled) interface.position *= 1000;
    const ReducedPart a = part.reduce(interfaces, 0), b = small.reduce(scaled, 0);
    VectorXd mm(12);  // a displacement of one metre in the freedoms of the other
    mm << 1e3, 1e3, 1e3, 1, 1, 1, 1e3, 1e3, 1e3, 1, 1, 1;
    // Energies: N mm and t mm²/s² are mJ.
    CHECK(relative_error(1e-3 * mm.asDiagonal() * b.stiffness * mm.asDiagonal(), a.stiffness) < 1e-10);
    CHECK(relative_error(1e-3 * mm.asDiagonal() * b.mass * mm.asDiagonal(), a.mass) < 1e-12);
  }
}

TEST_CASE("Points without elements change nothing") {
  const Part part;
  Part more = part;
  const auto n = part.points.rows();
  more.points.conservativeResize(n + 1, 3);
  more.points.bottomRows(1).setConstant(7);
  more.K.conservativeResize(3 * n + 3, 3 * n + 3);
  more.M.conservativeResize(3 * n + 3, 3 * n + 3);
  for (const auto& [first, second] : kinds) {
    const ReducedPart a = part.reduce(part.ends(first, second), 0);
    const ReducedPart b = more.reduce(part.ends(first, second), 0);
    CHECK(relative_error(b.stiffness, a.stiffness) < 1e-12);
    CHECK(largest(b.recovery.bottomRows(3)) == 0);
    CHECK(b.statistics.unused_points == 1);
  }
}

TEST_CASE("Requests and parts that have no answer are refused") {
  const Part part;
  const std::vector<Interface> ends = part.ends(rigid, rigid);
  CHECK(refusal(part, ends, {.modes = -1}) == "the number of modes must not be negative, got -1");
  CHECK(refusal(part, ends, {.max_frequency = -5}).find("must be positive, got -5.0") != std::string::npos);
  CHECK(refusal(part, ends, {.modes = 3, .max_frequency = 100}).find("got both") != std::string::npos);
  CHECK(refusal(Part(1, 1, 1), Part(1, 1, 1).ends(rigid, rigid)).find("nothing is left to reduce") !=
        std::string::npos);
  std::vector<Interface> twins = {part.plane(0, rigid, "base"), part.plane(3, average, "a"),
                                  part.plane(3, average, "b")};
  CHECK(refusal(part, twins).find("interface 'a', 'b': frames on average do not move on their own") == 0);
}

TEST_CASE("All modes of a part are its freedoms less six an average interface, three a point held rigidly") {
  // Held frames leave K⁻¹ motions that do not move; rounding must not count them as modes.
  const Part part(3, 2, 2);
  const auto n = part.K.rows();
  const auto n_modes = [&](const std::vector<Interface>& interfaces) {
    const flexarm::reduction::ReducedPart reduced = part.reduce(interfaces, 1000);
    CHECK(reduced.frequency_hz.allFinite());
    CHECK(std::isinf(reduced.quality.left_out_frequency_hz));
    return reduced.frequency_hz.size();
  };
  CHECK(n_modes({part.plane(0, average, "base")}) == n - 6);
  CHECK(n_modes(part.ends(average, average)) == n - 12);
  CHECK(n_modes(part.ends(rigid, average)) == n - 3 * 9 - 6);
  CHECK(n_modes(part.ends(rigid, rigid)) == n - 2 * 3 * 9);
}

TEST_CASE("A hinged piece is named by a point on it") {
  // Two blocks that share one edge of points: held at one end the other turns about that edge.
  const Part one(2, 1, 1);
  Part hinged = one;
  const auto n = one.points.rows();
  std::vector<int> place(static_cast<std::size_t>(n));
  int next = static_cast<int>(n);
  hinged.points.resize(2 * n - 2, 3);
  hinged.points.topRows(n) = one.points;
  for (int k = 0; k < n; ++k) {
    // The edge x = lx, z = 0 of the first is the edge x = 0, z = lz of the second, which lies ahead and
    // below.
    const Vector3d x = one.points.row(k).transpose() + Vector3d(Part::lx, 0, -Part::lz);
    int found = -1;
    for (int i = 0; i < n; ++i)
      if ((one.points.row(i).transpose() - x).norm() < 1e-9) found = i;
    place[static_cast<std::size_t>(k)] = found >= 0 ? found : next;
    if (found < 0) hinged.points.row(next++) = x.transpose();
  }
  REQUIRE(next == 2 * n - 2);
  for (const auto& [single, pair] : {std::pair{&one.K, &hinged.K}, {&one.M, &hinged.M}}) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int j = 0; j < single->outerSize(); ++j)
      for (SparseMatrix::InnerIterator it(*single, j); it; ++it) {
        const int row = static_cast<int>(it.row());
        const int a = 3 * place[static_cast<std::size_t>(row / 3)] + row % 3;
        const int b = 3 * place[static_cast<std::size_t>(j / 3)] + j % 3;
        entries.emplace_back(row, j, it.value());
        entries.emplace_back(std::max(a, b), std::min(a, b), it.value());
      }
    pair->resize(3 * hinged.points.rows(), 3 * hinged.points.rows());
    pair->setFromTriplets(entries.begin(), entries.end());
  }
  const std::string message = refusal(hinged, {one.plane(0, rigid, "base")});
  CHECK(message.find("with all interfaces held the part still moves there without force") !=
        std::string::npos);
  CHECK(message.find("point ") == 0);
}

TEST_CASE("Progress hears every phase in order, and what it throws ends the work") {
  struct Stop {};
  const Part part;
  std::vector<std::string> heard;
  const auto listen = [&](const char* phase, double done) {
    CHECK(done >= 0);
    CHECK(done <= 1);
    if (heard.empty() || heard.back() != phase) heard.emplace_back(phase);
  };
  flexarm::reduction::reduce_part(part.K, part.M, part.points, part.ends(rigid, rigid), {.modes = 6}, listen);
  CHECK(heard == std::vector<std::string>{"check", "factor", "interfaces", "modes", "matrices", "quality"});
  const auto stop = [](const char* phase, double) {
    if (std::string(phase) == "modes") throw Stop();
  };
  CHECK_THROWS_AS(flexarm::reduction::reduce_part(part.K, part.M, part.points, part.ends(rigid, rigid),
                                                  {.modes = 6}, stop),
                  Stop);
}

TEST_CASE("A part without mass has its statics, no modes, and nothing left out") {
  Part part;
  const MatrixXd stiffness = part.reduce(part.ends(rigid, average), 0).stiffness;
  part.M.setZero();
  const ReducedPart reduced = part.reduce(part.ends(rigid, average), 5);
  CHECK(error(reduced.stiffness, stiffness) == 0);
  CHECK(reduced.frequency_hz.size() == 0);
  CHECK(largest(reduced.mass) == 0);
  CHECK(reduced.quality.left_out_frequency_hz == INFINITY);
  CHECK(reduced.quality.free_frequency_hz.size() == 0);
}

}  // namespace flexarm::tests::craig_bampton_test
