#include "solids/blocks.hpp"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <array>
#include <map>

namespace flexarm::tests {

namespace {

/// Points by their place on a grid of half cells, numbered as they are first asked for.
class Grid {
 public:
  Grid(const Eigen::Vector3i& cells, Map map) : cells_(cells), map_(std::move(map)) {}

  int point(const Eigen::Vector3i& place) {
    const auto [entry, is_new] =
        numbers_.try_emplace({place[0], place[1], place[2]}, static_cast<int>(points_.size()));
    if (is_new)
      points_.push_back(
          map_((place.cast<double>().array() / (2.0 * cells_.cast<double>().array())).matrix()));
    return entry->second;
  }
  Points points() const {
    Points P(static_cast<Eigen::Index>(points_.size()), 3);
    for (std::size_t i = 0; i < points_.size(); ++i) P.row(static_cast<Eigen::Index>(i)) = points_[i];
    return P;
  }

 private:
  Eigen::Vector3i cells_;
  Map map_;
  std::map<std::array<int, 3>, int> numbers_;
  std::vector<Vector3d> points_;
};

/// Corners of a hexahedron, or of the six tetrahedra that fill it around its diagonal 0-6.
std::vector<std::vector<int>> corner_sets(CellType type) {
  if (!is_tetrahedron(type)) return {{0, 1, 2, 3, 4, 5, 6, 7}};
  return {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
}

/// Pairs of corners between which the further nodes lie, in the order of VTK.
std::vector<std::pair<int, int>> edges(CellType type) {
  if (type == CellType::tet10) return {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  if (type == CellType::hex20)
    return {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
  return {};
}

}  // namespace

SolidMesh mapped_box(CellType type, const Eigen::Vector3i& n, const Map& map, const SolidMaterial& material) {
  static const int corner[8][3] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0},
                                   {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2}};
  Grid grid(n, map);
  std::vector<std::vector<int>> cells;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i)
        for (const auto& set : corner_sets(type)) {
          std::vector<Eigen::Vector3i> places;
          for (int c : set)
            places.emplace_back(2 * i + corner[c][0], 2 * j + corner[c][1], 2 * k + corner[c][2]);
          for (const auto& [a, b] : edges(type))
            places.push_back((places[static_cast<std::size_t>(a)] + places[static_cast<std::size_t>(b)]) / 2);
          auto& nodes = cells.emplace_back();
          for (const auto& place : places) nodes.push_back(grid.point(place));
        }
  CellNodes nodes(static_cast<Eigen::Index>(cells.size()), nodes_per_cell(type));
  for (std::size_t c = 0; c < cells.size(); ++c)
    nodes.row(static_cast<Eigen::Index>(c)) =
        Eigen::Map<const Eigen::RowVectorXi>(cells[c].data(), static_cast<Eigen::Index>(cells[c].size()));
  return SolidMesh(grid.points(), {CellBlock{type, nodes, Eigen::VectorXi::Zero(nodes.rows())}}, {material});
}

Map scaled_to(const Vector3d& size) {
  return [size](const Vector3d& x) -> Vector3d { return size.cwiseProduct(x); };
}

SolidMesh with_points(const SolidMesh& mesh, const Points& points) {
  return SolidMesh(points, mesh.blocks(), mesh.materials());
}

SolidMesh with_material(const SolidMesh& mesh, const SolidMaterial& material) {
  return SolidMesh(mesh.points(), mesh.blocks(), {material});
}

SolidMesh distorted(const SolidMesh& mesh, double size, unsigned seed) {
  Random random(seed);
  Points points = mesh.points();
  for (Eigen::Index i = 0; i < points.rows(); ++i) points.row(i) += random.vector(3, size).transpose();
  return with_points(mesh, points);
}

MatrixXd dense(const SparseMatrix& lower) {
  const SparseMatrix full = lower.selfadjointView<Eigen::Lower>();
  return MatrixXd(full);
}

VectorXd times(const SparseMatrix& lower, const VectorXd& x) {
  return lower.selfadjointView<Eigen::Lower>() * x;
}

VectorXd at_points(const SolidMesh& mesh, const Map& field) {
  VectorXd u(mesh.n_dof());
  for (Eigen::Index i = 0; i < mesh.n_points(); ++i)
    u.segment<3>(3 * i) = field(mesh.points().row(i).transpose());
  return u;
}

MatrixXd rigid_motions(const SolidMesh& mesh) {
  MatrixXd R(mesh.n_dof(), 6);
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d e = Vector3d::Unit(axis);
    R.col(axis) = at_points(mesh, [&](const Vector3d&) { return e; });
    R.col(3 + axis) = at_points(mesh, [&](const Vector3d& x) -> Vector3d { return e.cross(x); });
  }
  return R;
}

std::vector<bool> freedoms(const SolidMesh& mesh, const std::function<bool(const Vector3d&, int)>& chosen) {
  std::vector<bool> found(static_cast<std::size_t>(mesh.n_dof()));
  for (Eigen::Index i = 0; i < mesh.n_dof(); ++i)
    found[static_cast<std::size_t>(i)] =
        chosen(mesh.points().row(i / 3).transpose(), static_cast<int>(i % 3));
  return found;
}

SparseMatrix free_part(const SparseMatrix& lower, const std::vector<bool>& held) {
  std::vector<int> place;
  int n = 0;
  for (bool h : held) place.push_back(h ? -1 : n++);
  std::vector<Eigen::Triplet<double>> entries;
  for (int column = 0; column < lower.cols(); ++column)
    for (SparseMatrix::InnerIterator entry(lower, column); entry; ++entry) {
      const int i = place[static_cast<std::size_t>(entry.row())], j = place[static_cast<std::size_t>(column)];
      if (i >= 0 && j >= 0) entries.emplace_back(i, j, entry.value());
    }
  SparseMatrix part(n, n);
  part.setFromTriplets(entries.begin(), entries.end());
  return part;
}

VectorXd free_part(const VectorXd& x, const std::vector<bool>& held) {
  VectorXd part(x.size());
  Eigen::Index n = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i)
    if (!held[static_cast<std::size_t>(i)]) part[n++] = x[i];
  part.conservativeResize(n);
  return part;
}

VectorXd solve(const SparseMatrix& K, const VectorXd& load, const std::vector<bool>& held,
               VectorXd prescribed) {
  for (Eigen::Index i = 0; i < prescribed.size(); ++i)
    if (!held[static_cast<std::size_t>(i)]) prescribed[i] = 0;
  const Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower> factor(free_part(K, held));
  REQUIRE(factor.info() == Eigen::Success);
  const VectorXd u = factor.solve(free_part(VectorXd(load - times(K, prescribed)), held));
  Eigen::Index n = 0;
  for (Eigen::Index i = 0; i < prescribed.size(); ++i)
    if (!held[static_cast<std::size_t>(i)]) prescribed[i] = u[n++];
  return prescribed;
}

}  // namespace flexarm::tests
