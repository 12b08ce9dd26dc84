#include <pybind11/eigen.h>

#include "bindings.hpp"
#include "flexarm/geometry/se3.hpp"

namespace py = pybind11;
using namespace flexarm::geometry;

void bind_geometry(py::module_& m) {
  py::class_<Frame>(m, "Frame", "A rigid placement: rotation matrix R and position x [m].")
      .def(py::init([](const Matrix3d& R, const Vector3d& x) { return Frame{R, x}; }),
           py::arg("R") = Matrix3d::Identity(), py::arg("x") = Vector3d::Zero())
      .def_readwrite("R", &Frame::R)
      .def_readwrite("x", &Frame::x)
      .def("inverse", &Frame::inverse)
      .def("__matmul__", [](const Frame& a, const Frame& b) { return a * b; }, py::arg("other"));
  m.def("exp6", &exp6, "Exponential of SE(3).", py::arg("h"));
  m.def("log6", &log6, "Logarithm of SE(3).", py::arg("H"));
}
