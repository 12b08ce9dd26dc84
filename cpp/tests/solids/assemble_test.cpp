#include "flexarm/solids/assemble.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "blocks.hpp"
#include "flexarm/errors.hpp"

namespace flexarm::tests::assemble_test {

namespace {

/// A curved, irregular mesh far from any symmetry.
SolidMesh irregular(CellType type, unsigned seed = 1) {
  return distorted(mapped_box(type, {2, 2, 2}, scaled_to({0.3, 0.2, 0.1})), 0.004, seed);
}

VectorXd eigenvalues(const SparseMatrix& lower) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(dense(lower), Eigen::EigenvaluesOnly).eigenvalues();
}

/// A field of constant strain; [Taylor1976] calls the test after it.
Vector3d patch_field(const Vector3d& x) {
  const Matrix3d gradient = (Matrix3d() << 1.0, 0.7, -0.4, 0.2, -0.6, 0.9, 0.5, -0.3, 0.8).finished() * 1e-3;
  return gradient * x + Vector3d(1e-4, -2e-4, 3e-4);
}

}  // namespace

TEST_CASE("Patch test: distorted cells reproduce every state of constant strain") {
  for (const CellType type : all_types) {
    // Straight edges for the quadratic cells: with curved ones a field linear in x is still among their
    // fields.
    for (const double nu : {0.3, 0.499}) {
      const SolidMesh mesh = with_material(irregular(type), {210e9, nu, 7850});
      const SparseMatrix K = assemble(mesh, false, 1).K;
      // Points that belong to the surface are found before the mesh is distorted.
      const Points straight = mapped_box(type, {2, 2, 2}, scaled_to({0.3, 0.2, 0.1})).points();
      std::vector<bool> held(static_cast<std::size_t>(mesh.n_dof()));
      for (Eigen::Index i = 0; i < mesh.n_dof(); ++i) {
        const Eigen::Array3d x = straight.row(i / 3).transpose().array() / Eigen::Array3d(0.3, 0.2, 0.1);
        held[static_cast<std::size_t>(i)] = (x < 1e-9 || x > 1 - 1e-9).any();
      }
      const VectorXd expected = at_points(mesh, patch_field);
      const VectorXd found = solve(K, VectorXd::Zero(mesh.n_dof()), held, expected);
      CAPTURE(name(type));
      CAPTURE(nu);
      CHECK(relative_error(found, expected) < 1e-12);
    }
  }
}

TEST_CASE("A rigid motion needs no force, and no other motion goes without") {
  for (const CellType type : all_types) {
    const SolidMesh one = distorted(mapped_box(type, {1, 1, 1}, scaled_to({0.3, 0.2, 0.1})), 0.004, 2);
    for (const SolidMesh& mesh : {one, irregular(type)}) {
      const SparseMatrix K = assemble(mesh, false, 1).K;
      const VectorXd w = eigenvalues(K);
      CAPTURE(name(type));
      for (int motion = 0; motion < 6; ++motion)
        CHECK(largest(times(K, rigid_motions(mesh).col(motion))) < 1e-14 * w.maxCoeff());
      CHECK(std::abs(w[5]) < 1e-13 * w.maxCoeff());
      CHECK(w[6] > 1e-5 * w.maxCoeff());  // no hourglass modes
    }
  }
}

TEST_CASE("A cell alone is as stiff as its rank: 6 rigid motions, all others strained") {
  for (const CellType type : {CellType::tet4, CellType::tet10, CellType::hex8, CellType::hex20}) {
    const auto nodes = mapped_box(type, {1, 1, 1}, scaled_to({1, 1, 1}));
    CellBlock cell = nodes.blocks()[0];
    cell.nodes.conservativeResize(1, Eigen::NoChange);
    cell.material.conservativeResize(1);
    const SparseMatrix K = assemble(SolidMesh(nodes.points(), {cell}, {block_steel}), false, 1).K;
    const VectorXd w = eigenvalues(K);
    CAPTURE(name(type));
    const int n_unused = static_cast<int>(nodes.n_dof()) - 3 * nodes_per_cell(type);
    CHECK((w.array().abs() < 1e-13 * w.maxCoeff()).count() == 6 + n_unused);
  }
}

TEST_CASE("In a turned frame stiffness and mass are the turned ones") {
  const Matrix3d R = Eigen::AngleAxisd(0.8, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  for (const CellType type : all_types) {
    const SolidMesh mesh = irregular(type);
    const Points turned = (mesh.points() * R.transpose()).rowwise() + Eigen::RowVector3d(3, -2, 5);
    const auto [K, M] = assemble(mesh, false, 1);
    const auto [K_turned, M_turned] = assemble(with_points(mesh, turned), false, 1);
    const MatrixXd T = [&] {
      MatrixXd blocks = MatrixXd::Zero(mesh.n_dof(), mesh.n_dof());
      for (Eigen::Index i = 0; i < mesh.n_points(); ++i) blocks.block<3, 3>(3 * i, 3 * i) = R;
      return blocks;
    }();
    CAPTURE(name(type));
    // Coordinates of some 5 m, in cells of 0.05 m, are rounded to 1e-14 of a cell.
    CHECK(relative_error(dense(K_turned), T * dense(K) * T.transpose()) < 1e-12);
    CHECK(relative_error(dense(M_turned), T * dense(M) * T.transpose()) < 1e-12);
  }
}

TEST_CASE("Numbers of points and the order of cells do not matter") {
  for (const CellType type : all_types) {
    const SolidMesh mesh = irregular(type);
    Eigen::PermutationMatrix<Eigen::Dynamic> order(mesh.n_points());
    order.setIdentity();
    std::mt19937 generator(3);
    std::shuffle(order.indices().begin(), order.indices().end(), generator);
    CellBlock block = mesh.blocks()[0];
    for (int& node : block.nodes.reshaped()) node = order.indices()[node];
    block.nodes = block.nodes.colwise().reverse().eval();
    const SolidMesh other(order * mesh.points(), {block}, {block_steel});
    const auto [K, M] = assemble(mesh, false, 1);
    const auto [K_other, M_other] = assemble(other, false, 1);
    Eigen::PermutationMatrix<Eigen::Dynamic> freedoms(mesh.n_dof());
    for (Eigen::Index i = 0; i < mesh.n_dof(); ++i)
      freedoms.indices()[i] = 3 * order.indices()[i / 3] + i % 3;
    CAPTURE(name(type));
    CHECK(relative_error(dense(K_other), freedoms * dense(K) * freedoms.transpose()) < 1e-13);
    CHECK(relative_error(dense(M_other), freedoms * dense(M) * freedoms.transpose()) < 1e-13);
  }
}

TEST_CASE("A cell numbered from another corner is the same cell") {
  const SolidMesh mesh =
      distorted(mapped_box(CellType::hex8, {1, 1, 1}, scaled_to({0.3, 0.2, 0.1})), 0.01, 4);
  CellBlock block = mesh.blocks()[0];
  block.nodes << Eigen::RowVectorXi(block.nodes)({5, 6, 2, 1, 4, 7, 3, 0});
  const auto [K, M] = assemble(mesh, false, 1);
  const auto [K_other, M_other] = assemble(SolidMesh(mesh.points(), {block}, {block_steel}), false, 1);
  CHECK(relative_error(dense(K_other), dense(K)) < 1e-13);
  CHECK(relative_error(dense(M_other), dense(M)) < 1e-13);
}

TEST_CASE("Any number of threads gives the same bits") {
  for (const CellType type : all_types) {
    const SolidMesh mesh = distorted(mapped_box(type, {6, 5, 4}, scaled_to({0.6, 0.5, 0.4})), 0.01, 5);
    const auto [K, M] = assemble(mesh, false, 1);
    for (const int n_threads : {2, 3, 7}) {
      const auto [K_other, M_other] = assemble(mesh, false, n_threads);
      CAPTURE(name(type));
      CHECK(std::equal(K.valuePtr(), K.valuePtr() + K.nonZeros(), K_other.valuePtr()));
      CHECK(std::equal(M.valuePtr(), M.valuePtr() + M.nonZeros(), M_other.valuePtr()));
      CHECK(std::equal(K.innerIndexPtr(), K.innerIndexPtr() + K.nonZeros(), K_other.innerIndexPtr()));
    }
  }
}

TEST_CASE("Mass and inertia of a brick are exact, consistent and lumped") {
  const Vector3d size(0.3, 0.2, 0.1);
  const double m = block_steel.density * size.prod();
  for (const CellType type : all_types) {
    const SolidMesh mesh = mapped_box(type, {3, 2, 2}, scaled_to(size));
    const MatrixXd R = rigid_motions(mesh);
    const MatrixXd consistent = R.transpose() * dense(assemble(mesh, false, 1).M) * R;
    CAPTURE(name(type));
    CHECK(relative_error(consistent.topLeftCorner<3, 3>(), m * Matrix3d::Identity()) < 1e-13);
    CHECK(consistent(2, 3) == near(m * size[1] / 2));  // m y_c: the z force of a roll about x
    CHECK(consistent(3, 3) == near(m * (size[1] * size[1] + size[2] * size[2]) / 3));
    CHECK(consistent(4, 4) == near(m * (size[0] * size[0] + size[2] * size[2]) / 3));
    CHECK(consistent(3, 4) == near(-m * size[0] * size[1] / 4));

    const SparseMatrix lumped = assemble(mesh, true, 1).M;
    CHECK(lumped.nonZeros() == mesh.n_dof());
    CHECK(VectorXd(lumped.diagonal()).minCoeff() > 0);
    CHECK(R.col(0).dot(times(lumped, R.col(0))) == near(m));
  }
}

TEST_CASE("Consistent mass is positive definite, also in curved cells") {
  for (const CellType type : all_types) CHECK(eigenvalues(assemble(irregular(type), false, 1).M)[0] > 0);
}

TEST_CASE("A collapsed hexahedron is a wedge: it passes the patch test and keeps its mass") {
  // Four wedges around an axis, in two layers; only the middle of the axis, point 9, lies inside.
  Points points(15, 3);
  CellNodes nodes(8, 8);
  for (int layer = 0; layer < 3; ++layer) {
    points.middleRows(5 * layer, 5) << 1, 0, layer, 0, 1.5, layer, -1, 0, layer, 0, -1, layer, 0.1, 0.2,
        layer;
    for (int k = 0; layer < 2 && k < 4; ++k) {
      const int a = 5 * layer + k, b = 5 * layer + (k + 1) % 4, axis = 5 * layer + 4;
      nodes.row(4 * layer + k) << axis, a, b, b, axis + 5, a + 5, b + 5, b + 5;
    }
  }
  points(9, 2) = 1.3;
  const SolidMesh mesh(points, {CellBlock{CellType::hex8, nodes, Eigen::VectorXi::Zero(8)}}, {block_steel});
  const auto [K, M] = assemble(mesh, false, 2);
  const VectorXd ones = VectorXd::Ones(mesh.n_dof());
  CHECK(ones.dot(times(M, ones)) / 3 == near(block_steel.density * 2.5 * 2));
  std::vector<bool> held(45, true);
  for (std::size_t dof : {27, 28, 29}) held[dof] = false;
  const VectorXd expected = at_points(mesh, patch_field);
  CHECK(relative_error(solve(K, VectorXd::Zero(45), held, expected), expected) < 1e-12);
  CHECK((eigenvalues(K).array() < 1e-13 * eigenvalues(K).maxCoeff()).count() == 6);
}

TEST_CASE("Blocks and materials add up; points of no cell get empty columns") {
  const SolidMesh one = mapped_box(CellType::hex8, {2, 1, 1}, scaled_to({2, 1, 1}));
  CellBlock first = one.blocks()[0], second = first;
  first.nodes = first.nodes.topRows(1).eval();
  second.nodes = second.nodes.bottomRows(1).eval();
  first.material = Eigen::VectorXi::Zero(1);
  second.material = Eigen::VectorXi::Ones(1);
  Points points(one.n_points() + 1, 3);
  points << one.points(), Eigen::RowVector3d(9, 9, 9);
  const SolidMaterial heavy{2 * block_steel.youngs_modulus, block_steel.poisson_ratio,
                            3 * block_steel.density};
  const auto [K, M] = assemble(SolidMesh(points, {first, second}, {block_steel, heavy}), false, 1);
  const auto [K1, M1] = assemble(SolidMesh(points, {first}, {block_steel}), false, 1);
  const auto [K2, M2] = assemble(SolidMesh(points, {second}, {block_steel, block_steel}), false, 1);
  CHECK(relative_error(dense(K), dense(K1) + 2 * dense(K2)) < 1e-14);
  CHECK(relative_error(dense(M), dense(M1) + 3 * dense(M2)) < 1e-14);
  for (int axis = 0; axis < 3; ++axis) CHECK(K.outerIndexPtr()[K.cols() - axis] == K.nonZeros());
}

TEST_CASE("A mesh that cannot be is refused by block, cell and value") {
  using flexarm::InvalidParameter;
  const SolidMesh good = mapped_box(CellType::hex8, {2, 1, 1}, scaled_to({2, 1, 1}));
  const CellBlock block = good.blocks()[0];
  const auto build = [&](const CellBlock& b, const SolidMaterial& m = block_steel) {
    return SolidMesh(good.points(), {b}, {m});
  };

  CellBlock bad = block;
  bad.nodes(1, 3) = 12;
  CHECK_THROWS_WITH_AS(build(bad), "block 0 (hex8), cell 1: node 12 is none of the 12 points, counted from 0",
                       InvalidParameter);
  bad = block;
  bad.material[1] = 1;
  CHECK_THROWS_WITH_AS(build(bad),
                       "block 0 (hex8), cell 1: material 1 is none of the 1 materials, counted from 0",
                       InvalidParameter);
  bad = block;
  bad.material.resize(1);
  CHECK_THROWS_WITH_AS(build(bad), "block 0 (hex8): needs one material for each of 2 cells, got 1",
                       InvalidParameter);
  bad = block;
  bad.type = CellType::tet4;
  CHECK_THROWS_WITH_AS(build(bad), "block 0 (tet4): a cell has 4 nodes, got 8", InvalidParameter);
  CHECK_THROWS_WITH_AS(build(block, {-1, 0.3, 1}), "material 0: Young's modulus must be positive, got -1 Pa",
                       InvalidParameter);
  CHECK_THROWS_WITH_AS(build(block, {1, 0.5, 1}),
                       "material 0: Poisson's ratio must lie between -1 and 0.5, got 0.5", InvalidParameter);
  CHECK_THROWS_WITH_AS(build(block, {1, 0.3, -2}), "material 0: density must not be negative, got -2 kg/m3",
                       InvalidParameter);
  CHECK_THROWS_AS(SolidMesh(good.points(), {}, {block_steel}), InvalidParameter);
  CHECK_THROWS_AS(assemble(good, false, -1), InvalidParameter);
}

TEST_CASE("An inverted or flat cell is refused by its number") {
  for (const CellType type : all_types) {
    const SolidMesh good = mapped_box(type, {2, 2, 2}, scaled_to({1, 1, 1}));
    // Cell 3 on mirrored copies of its points.
    Points points(2 * good.n_points(), 3);
    points << good.points(), good.points();
    points.col(0).tail(good.n_points()) *= -1;
    CellBlock block = good.blocks()[0];
    block.nodes.row(3).array() += static_cast<int>(good.n_points());
    const SolidMesh inverted(points, {block}, {block_steel});
    Points flat = good.points();
    flat.col(2).setZero();
    CAPTURE(name(type));
    CHECK(smallest_jacobians(inverted)[0][3] < 0);
    CHECK(smallest_jacobians(inverted)[0][2] > 0);
    CHECK(smallest_jacobians(with_points(good, flat))[0].cwiseAbs().maxCoeff() < 1e-12);
    for (const int n_threads : {1, 3}) {
      CHECK_THROWS_WITH_AS(assemble(inverted, false, n_threads),
                           doctest::Contains("cell 3 is inverted or flat"), flexarm::InvalidParameter);
      CHECK_THROWS_WITH_AS(assemble(with_points(good, flat), false, n_threads), doctest::Contains("cell 0"),
                           flexarm::InvalidParameter);
    }
  }
}

TEST_CASE("The scaled Jacobian is 1 for bricks and regular tetrahedra of any size") {
  const SolidMesh brick = mapped_box(CellType::hex8, {1, 1, 1}, scaled_to({3, 0.2, 1}));
  CHECK(smallest_jacobians(brick)[0][0] == near(1));
  Points points(4, 3);
  points << 1, 1, 1, -1, 1, -1, 1, -1, -1, -1, -1, 1;
  CellNodes nodes(1, 4);
  nodes << 0, 1, 2, 3;
  const SolidMesh regular(5 * points, {CellBlock{CellType::tet4, nodes, Eigen::VectorXi::Zero(1)}},
                          {block_steel});
  CHECK(smallest_jacobians(regular)[0][0] == near(1));
}

}  // namespace flexarm::tests::assemble_test
