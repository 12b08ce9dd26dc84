#include <pybind11/native_enum.h>
#include <pybind11/numpy.h>
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
  const ReducerSpring usual{1};
  py::class_<ReducerSpring>(m, "ReducerSpring", "Spring of a reducer: linear, stiffening, with backlash.")
      .def(py::init([](double k, double c, double k3, double gap, double w, double rho, double r) {
             return ReducerSpring{k, c, k3, gap, w, rho, r};
           }),
           py::arg("stiffness"), py::arg("damping") = 0.0, py::kw_only(), py::arg("cubic_stiffness") = 0.0,
           py::arg("gap") = 0.0, py::arg("fade_width") = usual.fade_width,
           py::arg("loose_stiffness") = usual.loose_stiffness,
           py::arg("loose_damping") = usual.loose_damping);
  py::class_<CableTorque>(m, "CableTorque", "Cables that bend with the joint.")
      .def(py::init([](double k, double rest) { return CableTorque{k, rest}; }), py::arg("stiffness"),
           py::arg("rest_angle") = 0.0);
  py::class_<ViscousFriction>(m, "ViscousFriction", "Viscous friction.")
      .def(py::init([](double b) { return ViscousFriction{b}; }), py::arg("coefficient"));
  py::class_<DahlFriction>(m, "DahlFriction", "Coulomb friction in Dahl's form.")
      .def(py::init([](double torque, double width) { return DahlFriction{torque, width}; }),
           py::arg("torque"), py::arg("width") = 2e-5);
  py::class_<LugreFriction>(m, "LugreFriction", "Friction by the LuGre model.")
      .def(py::init([](double s0, double s1, double s2, double coulomb, double breakaway, double rate) {
             return LugreFriction{s0, s1, s2, coulomb, breakaway, rate};
           }),
           py::kw_only(), py::arg("bristle_stiffness"), py::arg("bristle_damping"), py::arg("viscous"),
           py::arg("coulomb"), py::arg("breakaway"), py::arg("stribeck_rate"));
  py::native_enum<Of>(m, "Of", "enum.Enum")
      .value("angle", Of::angle)
      .value("rate", Of::rate)
      .value("torque", Of::torque)
      .value("motor_angle", Of::motor_angle)
      .value("across", Of::across)
      .finalize();
  py::class_<MonotoneCubic>(m, "MonotoneCubic", "Monotone cubic between knots, held beyond them.")
      .def(py::init<std::vector<double>, std::vector<double>>(), py::arg("x"), py::arg("value"))
      .def("slopes", &MonotoneCubic::slopes, "Least and largest slope.")
      .def(
          "__call__",
          [](const MonotoneCubic& table, const py::array_t<double>& x) {
            return py::vectorize([&](double at) { return table(at).y; })(x);
          },
          py::arg("x"));
  py::class_<ChangingTable>(m, "ChangingTable", "A table, or two of which one holds from an instant on.")
      .def(py::init<MonotoneCubic>(), py::arg("table"))
      .def(py::init<MonotoneCubic, MonotoneCubic, double, double>(), py::arg("before"), py::arg("after"),
           py::arg("instant"), py::arg("duration"));
  py::class_<TabulatedFriction>(m, "TabulatedFriction", "Friction in Dahl's form whose torque a table gives.")
      .def(py::init(
               [](MonotoneCubic table, double width) { return TabulatedFriction{std::move(table), width}; }),
           py::arg("table"), py::arg("width"));
  py::class_<TabulatedTorque>(m, "TabulatedTorque", "Torque at the output bearing by a table.")
      .def(py::init([](Of of, ChangingTable table) { return TabulatedTorque{of, std::move(table)}; }),
           py::arg("of"), py::arg("table"));
  py::class_<WoundSpring>(m, "WoundSpring", "Spring of a reducer that winds up by a table.")
      .def(py::init([](ReducerSpring spring, Of of, ChangingTable windup) {
             return WoundSpring{spring, of, std::move(windup)};
           }),
           py::arg("spring"), py::arg("of"), py::arg("windup"));
  py::class_<OilColumn>(m, "OilColumn", "Oil on both sides of a hydraulic piston.")
      .def(py::init([](double beta, double piston, double ring, double dead, double retracted, double stroke,
                       double damping) {
             return OilColumn{beta, piston, ring, dead, retracted, stroke, damping};
           }),
           py::kw_only(), py::arg("bulk_modulus"), py::arg("piston_area"), py::arg("ring_area"),
           py::arg("dead_volume"), py::arg("retracted"), py::arg("stroke"), py::arg("damping") = 0.0);
  py::class_<EndCushion>(m, "EndCushion", "End stops with cushions.")
      .def(py::init([](double low, double high, double stiffness, double length, double damping) {
             return EndCushion{low, high, stiffness, length, damping};
           }),
           py::kw_only(), py::arg("low"), py::arg("high"), py::arg("stiffness"), py::arg("length"),
           py::arg("damping") = 0.0);
  py::class_<RadialClearance>(m, "RadialClearance", "Play of a pin: one of its two slides.")
      .def(py::init([](ReducerSpring spring, int across) { return RadialClearance{spring, across}; }),
           py::arg("spring"), py::arg("across"));
  py::class_<Transmission>(m, "Transmission",
                           "psi = phi/scale + amplitude sin(multiple phi + phase) - windup(phi).")
      .def(py::init([](double scale, double amplitude, double multiple, double phase,
                       const std::optional<MonotoneCubic>& windup) {
             return Transmission{scale, amplitude, multiple, phase, windup.value_or(MonotoneCubic())};
           }),
           py::kw_only(), py::arg("scale") = 1.0, py::arg("amplitude") = 0.0, py::arg("multiple") = 0.0,
           py::arg("phase") = 0.0, py::arg("windup") = py::none());
  py::class_<DriveTrain>(m, "DriveTrain", "What stands between a motor and its link.")
      .def(py::init([](double ratio, double inertia, std::optional<Transmission> transmission,
                       std::vector<DriveTrain::Parallel> stages, DriveTrain::Parallel motor,
                       DriveTrain::Parallel bearing) {
             return DriveTrain{
                 ratio, inertia, transmission, std::move(stages), std::move(motor), std::move(bearing)};
           }),
           py::kw_only(), py::arg("gear_ratio") = 1.0, py::arg("rotor_inertia") = 0.0,
           py::arg("transmission") = py::none(), py::arg("stages") = std::vector<DriveTrain::Parallel>{},
           py::arg("motor") = DriveTrain::Parallel{}, py::arg("bearing") = DriveTrain::Parallel{});
}
