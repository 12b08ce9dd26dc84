#include <pybind11/native_enum.h>
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "flexarm/joints/drive_train.hpp"
#include "flexarm/joints/joint_constraint.hpp"

namespace py = pybind11;
using namespace flexarm::joints;

void bind_joints(py::module_& m) {
  py::native_enum<JointType>(m, "JointType", "enum.Enum")
      .value("revolute", JointType::revolute)
      .value("prismatic", JointType::prismatic)
      .value("fixed", JointType::fixed)
      .value("spherical", JointType::spherical)
      .finalize();
  py::class_<LinearSpring>(m, "LinearSpring", "Linear spring and damper.")
      .def(py::init([](double k, double c) { return LinearSpring{k, c}; }), py::arg("stiffness"),
           py::arg("damping") = 0.0);
  py::class_<CubicSpring>(m, "CubicSpring", "Cubic stiffening.")
      .def(py::init([](double k) { return CubicSpring{k}; }), py::arg("stiffness"));
  py::class_<ViscousFriction>(m, "ViscousFriction", "Viscous friction.")
      .def(py::init([](double b) { return ViscousFriction{b}; }), py::arg("coefficient"));
  py::class_<DahlFriction>(m, "DahlFriction", "Coulomb friction in Dahl's form.")
      .def(py::init([](double torque, double width) { return DahlFriction{torque, width}; }),
           py::arg("torque"), py::arg("width") = 2e-5);
  py::class_<DriveTrain>(m, "DriveTrain", "What stands between a motor and its link.")
      .def(py::init([](double ratio, double inertia, std::vector<DriveTrain::Parallel> stages,
                       DriveTrain::Parallel motor, DriveTrain::Parallel bearing) {
             return DriveTrain{ratio, inertia, std::move(stages), std::move(motor), std::move(bearing)};
           }),
           py::kw_only(), py::arg("gear_ratio") = 1.0, py::arg("rotor_inertia") = 0.0,
           py::arg("stages") = std::vector<DriveTrain::Parallel>{}, py::arg("motor") = DriveTrain::Parallel{},
           py::arg("bearing") = DriveTrain::Parallel{});
}
