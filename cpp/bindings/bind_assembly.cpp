#include <pybind11/eigen.h>
#include <pybind11/native_enum.h>
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "checks.hpp"
#include "flexarm/assembly/system.hpp"

namespace py = pybind11;
using namespace flexarm::assembly;

void bind_assembly(py::module_& m) {
  py::native_enum<DriveKind>(m, "DriveKind", "enum.Enum")
      .value("motor_angle", DriveKind::motor_angle)
      .value("link_angle", DriveKind::link_angle)
      .value("torque", DriveKind::torque)
      .value("free", DriveKind::free)
      .value("locked", DriveKind::locked)
      .finalize();
  py::class_<PointLoad>(m, "PointLoad",
                        "Force and moment at a point, in base axes, or in the link's if it follows.")
      .def(py::init([](int point, const Vector3d& force, const Vector3d& moment, bool follows) {
             return PointLoad{point, force, moment, follows};
           }),
           py::kw_only(), py::arg("point"), py::arg("force") = Vector3d::Zero(),
           py::arg("moment") = Vector3d::Zero(), py::arg("follows") = false);
  py::class_<Loads>(m, "Loads", "What acts from outside: gravity and point loads.")
      .def(py::init([](const Vector3d& gravity, std::vector<PointLoad> points) {
             return Loads{gravity, std::move(points), {}};
           }),
           py::kw_only(), py::arg("gravity"), py::arg("points") = std::vector<PointLoad>{})
      .def_readwrite("gravity", &Loads::gravity);
  py::class_<State>(m, "State", "State of an arm at one instant.")
      .def_readonly("t", &State::t)
      .def_readonly("frames", &State::frames, "Node frames in the base frame.")
      .def_readonly("v", &State::v)
      .def_readonly("multipliers", &State::multipliers);
  py::class_<System, std::shared_ptr<System>>(m, "System", "An arm, assembled.")
      .def(py::init<const flexarm::model::Arm&, const std::map<std::string, DriveKind>&>(), py::arg("arm"),
           py::arg("drives"))
      .def_property_readonly("n_nodes", &System::n_nodes)
      .def_property_readonly("n_unknowns", &System::n_unknowns)
      .def_property_readonly("mass", &System::mass, "Mass of everything [kg].")
      .def_property_readonly("assembled", &System::assembled,
                             "Joint values at which loops were closed first; empty without closures.")
      .def_property_readonly(
          "redundant", [](const System& system) { return system.closures().redundant(); },
          "Conditions of closures that others repeat.")
      .def(
          "in_loop",
          [](const System& system, int joint) {
            checks::index("joint", joint, system.joints().size());
            return system.in_loop(joint);
          },
          "True for a joint of a loop.", py::arg("joint"))
      .def("count_closures_as", &System::count_closures_as,
           "Take the conditions of closures that count in a model with nearly the same.", py::arg("nominal"))
      .def("joints_to_hold", &System::joints_to_hold,
           "Candidates that must be held so that the loops cannot move.", py::arg("held"),
           py::arg("candidates"))
      .def("rigid_state", &System::rigid_state, "The undeformed arm.", py::arg("joint_values"))
      .def(
          "point_frame",
          [](const System& system, const State& state, int point) {
            checks::fits(system, state);
            checks::index("point", point, system.points().size());
            return system.point_frame(state, point);
          },
          "Frame of a point.", py::arg("state"), py::arg("point"))
      .def(
          "part_shape",
          [](const System& system, const State& state, int part) {
            checks::fits(system, state);
            checks::index("super-element", part, system.superelements().size());
            const auto& element = system.superelements()[static_cast<std::size_t>(part)];
            const auto shape = element.shape(system.configuration(element, state));
            return std::pair(shape.frame, shape.u);
          },
          "Frame of the k-th super-element and its displacements in the freedoms of its matrices.",
          py::arg("state"), py::arg("part"));
}
