#include <pybind11/eigen.h>
#include <pybind11/native_enum.h>
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "flexarm/solids/assemble.hpp"
#include "flexarm/solids/cell.hpp"
#include "flexarm/solids/mass_properties.hpp"
#include "flexarm/solids/stress.hpp"

namespace py = pybind11;
using namespace flexarm::solids;

namespace {

std::pair<SparseMatrix, SparseMatrix> assemble_pair(const SolidMesh& mesh, bool lumped, int threads) {
  const py::gil_scoped_release unlock;
  SolidMatrices matrices = assemble(mesh, lumped, threads);
  return {std::move(matrices.K), std::move(matrices.M)};
}

}  // namespace

void bind_solids(py::module_& m) {
  py::native_enum<CellType>(m, "CellType", "enum.Enum")
      .value("tet4", CellType::tet4)
      .value("tet10", CellType::tet10)
      .value("hex8", CellType::hex8)
      .value("hex20", CellType::hex20)
      .finalize();
  py::class_<SolidMaterial>(m, "SolidMaterial", "Isotropic linear elastic material of a solid.")
      .def(py::init([](double E, double nu, double rho) { return SolidMaterial{E, nu, rho}; }),
           py::arg("youngs_modulus"), py::arg("poisson_ratio"), py::arg("density"));
  py::class_<CellBlock>(m, "CellBlock", "Cells of one type, nodes in the order of VTK.")
      .def(py::init([](CellType type, CellNodes nodes, Eigen::VectorXi material) {
             return CellBlock{type, std::move(nodes), std::move(material)};
           }),
           py::arg("type"), py::arg("nodes"), py::arg("material"));
  py::class_<SolidMesh>(m, "SolidMesh", "A solid part: points, cells, materials.")
      .def(py::init<Points, std::vector<CellBlock>, std::vector<SolidMaterial>>(), py::arg("points"),
           py::arg("blocks"), py::arg("materials"))
      .def_property_readonly("n_points", &SolidMesh::n_points)
      .def_property_readonly("n_dof", &SolidMesh::n_dof);
  m.def("smallest_jacobians", &smallest_jacobians,
        "Smallest scaled Jacobian of each cell, one array a block; 1 is ideal, 0 flat, below inverted.",
        py::arg("mesh"), py::call_guard<py::gil_scoped_release>());
  m.def("assemble_solids", &assemble_pair, "Stiffness and mass, lower triangles; freedom 3 point + axis.",
        py::arg("mesh"), py::arg("lumped") = false, py::arg("threads") = 0);
  m.def(
      "mass_properties",
      [](const SolidMesh& mesh) {
        const MassProperties p = mass_properties(mesh);
        return std::make_tuple(p.mass, p.first_moment, p.inertia);
      },
      "Mass, first moment and inertia about the origin.", py::arg("mesh"),
      py::call_guard<py::gil_scoped_release>());
  m.def("stresses", &stresses, "Stresses of the points: xx, yy, zz, xy, yz, zx.", py::arg("mesh"),
        py::arg("displacements"), py::call_guard<py::gil_scoped_release>());
  m.def(
      "von_mises",
      [](const SolidMesh& mesh, const Points& displacements) {
        return von_mises(stresses(mesh, displacements));
      },
      "Von Mises stress of the points.", py::arg("mesh"), py::arg("displacements"),
      py::call_guard<py::gil_scoped_release>());
}
