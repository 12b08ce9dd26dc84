#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "flexarm/simulation/cubic_spline.hpp"
#include "flexarm/simulation/motion_samples.hpp"
#include "flexarm/simulation/piecewise_polynomial.hpp"
#include "flexarm/simulation/spline_fit.hpp"

namespace py = pybind11;
using namespace flexarm::simulation;

void bind_splines(py::module_& m) {
  py::class_<PiecewisePolynomial>(m, "PiecewisePolynomial",
                                  "Piecewise polynomial as scipy.interpolate.PPoly.")
      .def(py::init([](const Eigen::VectorXd& breaks, Eigen::MatrixXd coefficients) {
             return PiecewisePolynomial({breaks.begin(), breaks.end()}, std::move(coefficients));
           }),
           py::arg("breaks"), py::arg("coefficients"))
      .def_static("constant", &PiecewisePolynomial::constant, py::arg("value"))
      .def(
          "__call__", [](const PiecewisePolynomial& p, double t) { return p(t); },
          "Value and two derivatives.", py::arg("t"));
  m.def("cubic_spline", &cubic_spline, "Coefficients of the not-a-knot spline through samples.", py::arg("x"),
        py::arg("y"));
  m.def(
      "spline_equations",
      [](const SampleRef& time, const SampleRef& values, const BreakRef& breaks) {
        auto found = spline_equations(time, values, breaks);
        return std::pair(std::move(found.band), std::move(found.right));
      },
      "Normal equations of a cubic least-squares spline: lower band and right side.", py::arg("time"),
      py::arg("values"), py::arg("breaks"));
  m.def("sample_motion", &sample_motion, "Values of a motion at any instants, by cubics between its steps.",
        py::arg("time"), py::arg("values"), py::arg("rates"), py::arg("instants"), py::arg("early"));
  m.def("spline_values", &spline_values, "Values of a cubic spline at its samples.", py::arg("time"),
        py::arg("breaks"), py::arg("coefficients"));
}
