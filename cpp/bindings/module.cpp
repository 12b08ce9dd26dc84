/// @file
/// flexarm._core: the C++ core as Python sees it. Each folder of the core binds itself in its own bind_*.cpp.
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "flexarm/build_info.hpp"
#include "flexarm/errors.hpp"
#include "flexarm/interrupt.hpp"
#include "flexarm/number_rows.hpp"

namespace py = pybind11;

namespace {

/// Class `name` of flexarm.errors, imported when it is first needed.
py::object error_class(const char* name) { return py::module_::import("flexarm.errors").attr(name); }

void translate(std::exception_ptr pointer) {
  try {
    if (pointer) std::rethrow_exception(pointer);
  } catch (const flexarm::InvalidParameter& error) {
    py::set_error(error_class("InvalidParameter"), error.what());
  } catch (const flexarm::NotConverged& error) {
    const py::object type = error_class("NotConverged");
    const py::object instance =
        type(error.what(), py::arg("time") = error.time, py::arg("iteration") = error.iteration,
             py::arg("residual") = error.residual);
    PyErr_SetObject(type.ptr(), instance.ptr());
  }
}

/// Python's signal handlers run here, Ctrl-C's among them, if this is the main thread.
void check_signals() {
  const py::gil_scoped_acquire lock;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

void bind_build_info(py::module_& m) {
  using flexarm::BuildInfo;
  py::class_<BuildInfo>(m, "BuildInfo", "Versions, backends and licence of the core.")
      .def_readonly("version", &BuildInfo::version)
      .def_readonly("git", &BuildInfo::git_commit, "Empty where it is unknown.")
      .def_readonly("compiler", &BuildInfo::compiler)
      .def_readonly("build_type", &BuildInfo::build_type)
      .def_readonly("eigen", &BuildInfo::eigen)
      .def_readonly("suitesparse", &BuildInfo::suitesparse, "Empty where it is not used.")
      .def_readonly("solver", &BuildInfo::solver)
      .def_readonly("ordering", &BuildInfo::ordering)
      .def_readonly("blas", &BuildInfo::blas)
      .def_readonly("cholmod", &BuildInfo::cholmod)
      .def_readonly("licence", &BuildInfo::licence);
  m.def("build_info", &flexarm::build_info, "What this build of the core is made of.");
}

}  // namespace

PYBIND11_MODULE(_core, m) {
  m.doc() = "C++ core of flexarm (private).";
  py::register_exception_translator(&translate);
  flexarm::set_interrupt_check(&check_signals);
  bind_build_info(m);
  m.def("number_rows", &flexarm::number_rows,
        "Numbers of some columns of rows of text; None if one is no number.", py::arg("text"),
        py::arg("cells"), py::arg("columns"));
  bind_geometry(m);
  bind_joints(m);
  bind_model(m);
  bind_assembly(m);
  bind_splines(m);
  bind_simulation(m);
  bind_stepping(m);
  bind_solids(m);
  bind_reduction(m);
}
