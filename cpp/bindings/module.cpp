/// @file
/// flexarm._core: the C++ core as Python sees it. Each folder of the core binds itself in its own bind_*.cpp.
#include <pybind11/pybind11.h>

#include "flexarm/build_info.hpp"
#include "flexarm/errors.hpp"

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

py::dict build_info() {
  const flexarm::BuildInfo info = flexarm::build_info();
  py::dict d;
  d["version"] = info.version;
  d["git"] = info.git;
  d["compiler"] = info.compiler;
  d["build_type"] = info.build_type;
  d["eigen"] = info.eigen;
  d["suitesparse"] = info.suitesparse;
  d["solver"] = info.solver;
  d["ordering"] = info.ordering;
  d["blas"] = info.blas;
  d["licence"] = info.licence;
  d["cholmod_found"] = info.cholmod_found;
  return d;
}

}  // namespace

PYBIND11_MODULE(_core, m) {
  m.doc() = "C++ core of flexarm (private).";
  py::register_exception_translator(&translate);
  m.def("build_info", &build_info, "What this build of the core is made of.");
}
