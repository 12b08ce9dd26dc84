#include <pybind11/eigen.h>
#include <pybind11/native_enum.h>
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "flexarm/model/arm.hpp"

namespace py = pybind11;
using namespace flexarm::model;

void bind_model(py::module_& m) {
  py::class_<Section>(m, "Section",
                      "Properties of a cross-section, shear factors included in the shear areas.")
      .def(py::init([](double A, double Iy, double Iz, double J, double Ay, double Az) {
             return Section{A, Iy, Iz, J, Ay, Az};
           }),
           py::kw_only(), py::arg("area"), py::arg("second_moment_y"), py::arg("second_moment_z"),
           py::arg("torsion_constant"), py::arg("shear_area_y") = std::numeric_limits<double>::infinity(),
           py::arg("shear_area_z") = std::numeric_limits<double>::infinity())
      .def_readonly("area", &Section::area)
      .def_readonly("second_moment_y", &Section::second_moment_y)
      .def_readonly("second_moment_z", &Section::second_moment_z)
      .def_readonly("torsion_constant", &Section::torsion_constant)
      .def_readonly("shear_area_y", &Section::shear_area_y)
      .def_readonly("shear_area_z", &Section::shear_area_z);
  m.def("tube_section", &tube_section, "Section of a tube.", py::arg("outer_diameter"), py::arg("thickness"));
  m.def("round_section", &round_section, "Section of a solid rod.", py::arg("diameter"));
  m.def("rectangle_section", &rectangle_section, "Rectangular section.", py::arg("width"), py::arg("height"));
  py::class_<Material>(m, "Material", "Isotropic linear elastic material.")
      .def(py::init([](double E, double G, double rho) { return Material{E, G, rho}; }), py::kw_only(),
           py::arg("youngs_modulus"), py::arg("shear_modulus"), py::arg("density"));
  py::native_enum<BeamTheory>(m, "BeamTheory", "enum.Enum")
      .value("timoshenko", BeamTheory::timoshenko)
      .value("euler_bernoulli", BeamTheory::euler_bernoulli)
      .finalize();
  py::class_<StateTable>(m, "StateTable", "What a table of a joint's state gives, in a direction.")
      .def(py::init([](std::string joint, flexarm::joints::Of of, flexarm::joints::ChangingTable table,
                       const Vector3d& direction) {
             return StateTable{std::move(joint), of, std::move(table), direction};
           }),
           py::kw_only(), py::arg("joint"), py::arg("of"), py::arg("table"),
           py::arg("direction") = Vector3d::Zero());
  py::class_<BeamLink>(m, "BeamLink", "A straight beam.")
      .def(py::init([](std::string name, const Vector3d& end, const Vector3d& up, const Section& section,
                       const Material& material, BeamTheory theory, int elements, double damping_ratio,
                       double bending_scale, double mass_scale, const Vector3d& bow, double bow_time,
                       std::optional<StateTable> curvature) {
             return BeamLink{std::move(name),
                             end,
                             up,
                             section,
                             material,
                             theory,
                             elements,
                             damping_ratio,
                             bending_scale,
                             mass_scale,
                             bow,
                             bow_time,
                             std::move(curvature)};
           }),
           py::kw_only(), py::arg("name"), py::arg("end"), py::arg("up") = Vector3d::Zero(),
           py::arg("section"), py::arg("material"),
           py::arg_v("theory", BeamTheory::timoshenko, "BeamTheory.timoshenko"), py::arg("elements") = 4,
           py::arg("damping_ratio") = 0.0, py::arg("bending_scale") = 1.0, py::arg("mass_scale") = 1.0,
           py::arg("bow") = Vector3d::Zero(), py::arg("bow_time") = 0.0, py::arg("curvature") = py::none());
  py::class_<RigidLink>(m, "RigidLink", "A rigid body.")
      .def(py::init([](std::string name, double mass, const Vector3d& com, const Matrix3d& inertia) {
             return RigidLink{std::move(name), mass, com, inertia};
           }),
           py::kw_only(), py::arg("name"), py::arg("mass") = 0.0, py::arg("com") = Vector3d::Zero(),
           py::arg("inertia") = Matrix3d::Zero());
  py::class_<SuperElementLink>(m, "SuperElementLink", "A part reduced to interfaces and internal modes.")
      .def(py::init([](std::string name, std::vector<std::string> interfaces,
                       std::vector<flexarm::geometry::Frame> frames, Eigen::MatrixXd stiffness,
                       Eigen::MatrixXd mass, Eigen::MatrixXd damping, double damping_ratio) {
             return SuperElementLink{std::move(name),      std::move(interfaces), std::move(frames),
                                     std::move(stiffness), std::move(mass),       std::move(damping),
                                     damping_ratio};
           }),
           py::kw_only(), py::arg("name"), py::arg("interfaces"), py::arg("frames"), py::arg("stiffness"),
           py::arg("mass"), py::arg("damping") = Eigen::MatrixXd(), py::arg("damping_ratio") = 0.0);
  py::class_<Payload>(m, "Payload", "A concentrated mass.")
      .def(py::init([](std::string name, std::string link, const Vector3d& position, double mass,
                       const Matrix3d& inertia, const Vector3d& offset, std::optional<StateTable> force) {
             return Payload{std::move(name), std::move(link), position,        mass,
                            inertia,         offset,          std::move(force)};
           }),
           py::kw_only(), py::arg("name"), py::arg("link"), py::arg("position") = Vector3d::Zero(),
           py::arg("mass"), py::arg("inertia") = Matrix3d::Zero(), py::arg("offset") = Vector3d::Zero(),
           py::arg("force") = py::none());
  py::class_<flexarm::model::Point>(m, "Point", "A place to look at, or to push at.")
      .def(py::init([](std::string name, std::string link, const Vector3d& position, bool loaded) {
             return flexarm::model::Point{std::move(name), std::move(link), position, loaded};
           }),
           py::kw_only(), py::arg("name"), py::arg("link"), py::arg("position") = Vector3d::Zero(),
           py::arg("loaded") = false);
  py::class_<Hinge>(m, "Hinge", "A hinge on a spring, which nothing drives.")
      .def(
          py::init([](const Vector3d& axis, double stiffness, double damping, flexarm::joints::JointType type,
                      flexarm::joints::DriveTrain::Parallel laws, std::optional<StateTable> follows) {
            return Hinge{axis, stiffness, damping, type, std::move(laws), std::move(follows)};
          }),
          py::kw_only(), py::arg("axis"), py::arg("stiffness"), py::arg("damping") = 0.0,
          py::arg("type") = flexarm::joints::JointType::revolute,
          py::arg("laws") = flexarm::joints::DriveTrain::Parallel{}, py::arg("follows") = py::none());
  py::class_<Joint>(m, "Joint", "A joint with its drive train.")
      .def(py::init([](std::string name, flexarm::joints::JointType type, std::string parent,
                       std::string child, bool at_end, const flexarm::geometry::Frame& origin,
                       const Vector3d& axis, const flexarm::joints::DriveTrain& drive_train,
                       std::vector<Hinge> mount) {
             return Joint{std::move(name), type, std::move(parent), std::move(child), at_end,
                          origin,          axis, drive_train,       std::move(mount)};
           }),
           py::kw_only(), py::arg("name"), py::arg("type"), py::arg("parent"), py::arg("child"),
           py::arg("at_end") = false, py::arg("origin"), py::arg("axis"), py::arg("drive_train"),
           py::arg("mount") = std::vector<Hinge>{});
  py::class_<Gear>(m, "Gear", "theta of input = ratio times theta of output.")
      .def(py::init([](std::string name, std::string input, std::string output, double ratio) {
             return Gear{std::move(name), std::move(input), std::move(output), ratio};
           }),
           py::kw_only(), py::arg("name"), py::arg("input"), py::arg("output"), py::arg("ratio"));
  py::class_<Pedestal>(m, "Pedestal", "A base that turns on a spring, and may be shaken.")
      .def(py::init(
               [](std::vector<Hinge> hinges, const Vector3d& axis, double amplitude, double frequency,
                  double phase) { return Pedestal{std::move(hinges), axis, amplitude, frequency, phase}; }),
           py::kw_only(), py::arg("hinges"), py::arg("axis"), py::arg("amplitude") = 0.0,
           py::arg("frequency") = 0.0, py::arg("phase") = 0.0);
  using flexarm::joints::ClosureType;
  py::native_enum<ClosureType>(m, "ClosureType", "enum.Enum")
      .value("revolute", ClosureType::revolute)
      .value("spherical", ClosureType::spherical)
      .value("universal", ClosureType::universal)
      .value("cylindrical", ClosureType::cylindrical)
      .value("prismatic", ClosureType::prismatic)
      .value("fixed", ClosureType::fixed)
      .value("point_on_line", ClosureType::point_on_line)
      .value("point_on_beam", ClosureType::point_on_beam)
      .finalize();
  py::class_<Closure>(m, "Closure", "Closes a loop of the tree.")
      .def(py::init([](std::string name, ClosureType type, std::string a, std::string b, bool a_at_end,
                       bool b_at_end, const flexarm::geometry::Frame& a_origin,
                       const flexarm::geometry::Frame& b_origin, const Vector3d& axis,
                       const Vector3d& second_axis, std::vector<Hinge> mount,
                       flexarm::joints::DriveTrain::Parallel bearing) {
             return Closure{
                 std::move(name), type,     std::move(a), std::move(b), a_at_end,         b_at_end,
                 a_origin,        b_origin, axis,         second_axis,  std::move(mount), std::move(bearing)};
           }),
           py::kw_only(), py::arg("name"), py::arg("type"), py::arg("a"), py::arg("b"),
           py::arg("a_at_end") = false, py::arg("b_at_end") = false, py::arg("a_origin"), py::arg("b_origin"),
           py::arg("axis"), py::arg("second_axis") = Vector3d::UnitX(),
           py::arg("mount") = std::vector<Hinge>{},
           py::arg("bearing") = flexarm::joints::DriveTrain::Parallel{});
  py::class_<Arm>(m, "Arm", "An arm as plain data.")
      .def(py::init([](std::string name, const Vector3d& gravity, std::vector<Link> links,
                       std::vector<Joint> joints, std::vector<Payload> payloads,
                       std::vector<flexarm::model::Point> points, std::vector<Gear> gears,
                       std::optional<Pedestal> pedestal, std::vector<Closure> closures,
                       std::map<std::string, double> assembly) {
             return Arm{std::move(name),     gravity,
                        std::move(links),    std::move(joints),
                        std::move(payloads), std::move(points),
                        std::move(gears),    pedestal,
                        std::move(closures), std::move(assembly)};
           }),
           py::kw_only(), py::arg("name"), py::arg("gravity"), py::arg("links"), py::arg("joints"),
           py::arg("payloads"), py::arg("points"), py::arg("gears"), py::arg("pedestal") = py::none(),
           py::arg("closures") = std::vector<Closure>{},
           py::arg("assembly") = std::map<std::string, double>{});
}
