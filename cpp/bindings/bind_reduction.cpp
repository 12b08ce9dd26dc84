#include <pybind11/eigen.h>
#include <pybind11/native_enum.h>
#include <pybind11/stl.h>

#include <string>

#include "bindings.hpp"
#include "flexarm/errors.hpp"
#include "flexarm/reduction/craig_bampton.hpp"

namespace py = pybind11;
using namespace flexarm::reduction;
using flexarm::linear_solvers::CholeskyReport;

namespace {

using MappedMatrix = Eigen::Map<const Eigen::SparseMatrix<double>>;
template <typename Number>
using Column = py::array_t<Number, py::array::c_style | py::array::forcecast>;

/// Lower triangle of a scipy.sparse matrix, on SciPy's own memory where that has the right types.
class SharedMatrix {
 public:
  SharedMatrix(const py::object& matrix, const char* name) {
    if (!py::hasattr(matrix, "tocsc"))
      throw flexarm::InvalidParameter(std::string(name) + " matrix: must be one of scipy.sparse, got " +
                                      py::type::of(matrix).attr("__name__").cast<std::string>());
    py::object columns = matrix.attr("tocsc")();
    try {
      columns.attr("check_format")(true);  // its indices are within the matrix
    } catch (const py::error_already_set& error) {
      throw flexarm::InvalidParameter(std::string(name) + " matrix: " + error.what());
    }
    if (!columns.attr("has_canonical_format").cast<bool>()) {
      columns = columns.attr("copy")();
      columns.attr("sum_duplicates")();
    }
    columns_ = Column<int>(py::object(columns.attr("indptr")));
    rows_ = Column<int>(py::object(columns.attr("indices")));
    values_ = Column<double>(py::object(columns.attr("data")));
    shape_ = columns.attr("shape").cast<std::pair<py::ssize_t, py::ssize_t>>();
    for (py::ssize_t j = 0; j < shape_.second; ++j) {
      const int first = columns_.at(j);
      if (first == columns_.at(j + 1) || rows_.at(first) >= j) continue;
      throw flexarm::InvalidParameter(std::string(name) + " matrix: only its lower triangle is wanted, row " +
                                      std::to_string(rows_.at(first)) + " of column " + std::to_string(j) +
                                      " lies above; scipy.sparse.tril(matrix) takes it");
    }
  }
  MappedMatrix map() const {
    return {shape_.first, shape_.second, values_.size(), columns_.data(), rows_.data(), values_.data()};
  }

 private:
  Column<int> columns_, rows_;
  Column<double> values_;
  std::pair<py::ssize_t, py::ssize_t> shape_;
};

/// Runs without the interpreter's lock; takes it for signals (Ctrl-C) and the caller's progress, whose
/// exceptions end the work.
ReducedPart reduce_matrices(const py::object& stiffness, const py::object& mass,
                            const Coordinates& coordinates, const std::vector<Interface>& interfaces,
                            int modes, double max_frequency, const py::object& progress) {
  const SharedMatrix K(stiffness, "stiffness"), M(mass, "mass");
  const ReductionProgress poll = [&](const char* phase, double done) {
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!progress.is_none()) progress(phase, done);
  };
  const py::gil_scoped_release unlock;
  return reduce_part(K.map(), M.map(), coordinates, interfaces, {modes, max_frequency}, poll);
}

void bind_interface(py::module_& m) {
  py::native_enum<InterfaceKind>(m, "InterfaceKind", "enum.Enum")
      .value("rigid", InterfaceKind::rigid)
      .value("average", InterfaceKind::average)
      .finalize();
  py::class_<Interface>(m, "Interface", "Points of a part tied to a frame of six freedoms.")
      .def(py::init([](std::string name, const Eigen::Vector3d& position, const Eigen::Matrix3d& rotation,
                       std::vector<int> points, InterfaceKind kind, Eigen::VectorXd weights) {
             return Interface{std::move(name),   position, rotation,
                              std::move(points), kind,     std::move(weights)};
           }),
           py::arg("name"), py::arg("position"), py::arg("rotation"), py::arg("points"), py::arg("kind"),
           py::arg("weights") = Eigen::VectorXd())
      .def_readonly("name", &Interface::name)
      .def_readonly("position", &Interface::position)
      .def_readonly("rotation", &Interface::rotation)
      .def_readonly("points", &Interface::points)
      .def_readonly("kind", &Interface::kind)
      .def_readonly("weights", &Interface::weights, "Empty: equal.");
}

void bind_reports(py::module_& m) {
  py::class_<CholeskyReport>(m, "CholeskyReport", "How the factor of a part came about.")
      .def_readonly("backend", &CholeskyReport::backend)
      .def_readonly("ordering", &CholeskyReport::ordering)
      .def_readonly("blas", &CholeskyReport::blas)
      .def_readonly("entries", &CholeskyReport::entries)
      .def_readonly("entries_amd", &CholeskyReport::entries_amd)
      .def_readonly("entries_metis", &CholeskyReport::entries_metis, "0 where there is no METIS.")
      .def_readonly("operations", &CholeskyReport::operations)
      .def_readonly("seconds_ordering", &CholeskyReport::seconds_ordering)
      .def_readonly("seconds_factor", &CholeskyReport::seconds_factor);
  py::class_<ReductionStatistics>(m, "ReductionStatistics", "Sizes, backends and seconds of a reduction.")
      .def_readonly("factor", &ReductionStatistics::factor)
      .def_readonly("n_freedoms", &ReductionStatistics::n_freedoms)
      .def_readonly("n_inner", &ReductionStatistics::n_inner)
      .def_readonly("unused_points", &ReductionStatistics::unused_points)
      .def_readonly("lanczos_steps", &ReductionStatistics::lanczos_steps)
      .def_readonly("lanczos_block", &ReductionStatistics::lanczos_block)
      .def_readonly("seconds_check", &ReductionStatistics::seconds_check)
      .def_readonly("seconds_factor", &ReductionStatistics::seconds_factor)
      .def_readonly("seconds_interfaces", &ReductionStatistics::seconds_interfaces)
      .def_readonly("seconds_modes", &ReductionStatistics::seconds_modes)
      .def_readonly("seconds_matrices", &ReductionStatistics::seconds_matrices)
      .def_readonly("seconds_quality", &ReductionStatistics::seconds_quality)
      .def_readonly("seconds", &ReductionStatistics::seconds);
  py::class_<ReductionQuality>(m, "ReductionQuality", "What a reduction is good for.")
      .def_readonly("left_out_frequency_hz", &ReductionQuality::left_out_frequency_hz)
      .def_readonly("trusted_frequency_hz", &ReductionQuality::trusted_frequency_hz)
      .def_readonly("mass", &ReductionQuality::mass)
      .def_readonly("centre", &ReductionQuality::centre)
      .def_readonly("inertia", &ReductionQuality::inertia, "About the centre of mass.")
      .def_readonly("effective_mass", &ReductionQuality::effective_mass, "(mode, 6) [kg, kg m2]")
      .def_readonly("movable_mass", &ReductionQuality::movable_mass, "(6) of all modes together.")
      .def_readonly("mode_residual", &ReductionQuality::mode_residual)
      .def_readonly("free_frequency_hz", &ReductionQuality::free_frequency_hz)
      .def_readonly("free_frequency_error", &ReductionQuality::free_frequency_error)
      .def_readonly("rigid_body_correction", &ReductionQuality::rigid_body_correction);
}

}  // namespace

void bind_reduction(py::module_& m) {
  bind_interface(m);
  bind_reports(m);
  py::class_<ReducedPart>(m, "ReducedPart", "A part reduced to interfaces and inner modes.")
      .def_readonly("stiffness", &ReducedPart::stiffness)
      .def_readonly("mass", &ReducedPart::mass)
      .def_readonly("inertia_load", &ReducedPart::inertia_load, "(dof, 3)")
      .def_readonly("frequency_hz", &ReducedPart::frequency_hz)
      .def_readonly("recovery", &ReducedPart::recovery, "(3 n_points, dof)")
      .def_readonly("quality", &ReducedPart::quality)
      .def_readonly("statistics", &ReducedPart::statistics);
  m.def("reduce_part", &reduce_matrices, "Craig-Bampton (modes) or Guyan (none) reduction of a free part.",
        py::arg("stiffness"), py::arg("mass"), py::arg("coordinates"), py::arg("interfaces"),
        py::arg("modes") = 0, py::arg("max_frequency") = 0.0, py::arg("progress") = py::none());
}
