#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "checks.hpp"
#include "flexarm/errors.hpp"
#include "flexarm/simulation/consistent_forces.hpp"
#include "flexarm/simulation/reactions.hpp"
#include "flexarm/simulation/snapshots.hpp"
#include "flexarm/simulation/stepping.hpp"

namespace py = pybind11;
using namespace flexarm::simulation;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using flexarm::integrators::HhtMemory;
using flexarm::integrators::Linearisation;

namespace {

using Arrays = std::map<std::string, MatrixXd>;

/// A state as named arrays, whose last bits are the state's.
Arrays arrays(const State& state) {
  const auto n = static_cast<Index>(state.frames.size());
  MatrixXd frames(n, 12), laws(static_cast<Index>(state.laws.size()), 2);
  for (Index k = 0; k < n; ++k) {
    const auto& [R, x] = state.frames[static_cast<std::size_t>(k)];
    frames.row(k) << R.row(0), R.row(1), R.row(2), x.transpose();
  }
  for (Index k = 0; k < laws.rows(); ++k) {
    const auto& memory = state.laws[static_cast<std::size_t>(k)];
    laws.row(k) << memory.x, memory.z;
  }
  return {{"time", MatrixXd::Constant(1, 1, state.t)},
          {"frames", frames},
          {"scalars", state.s},
          {"velocities", state.v},
          {"accelerations", state.v_dot},
          {"algorithmic_accelerations", state.a},
          {"multipliers", state.multipliers},
          {"laws", laws}};
}

const MatrixXd& of_size(const Arrays& given, const std::string& name, Index rows, Index columns) {
  const auto found = given.find(name);
  if (found == given.end()) throw flexarm::InvalidParameter("the stored state has no array '" + name + "'");
  const MatrixXd& array = found->second;
  if (array.rows() != rows || array.cols() != columns) {
    throw flexarm::InvalidParameter("array '" + name + "' of the stored state must be " +
                                    std::to_string(rows) + " x " + std::to_string(columns) + ", got " +
                                    std::to_string(array.rows()) + " x " + std::to_string(array.cols()));
  }
  if (!array.allFinite()) {
    throw flexarm::InvalidParameter("array '" + name +
                                    "' of the stored state holds numbers that are not "
                                    "finite");
  }
  return array;
}

State state_of(const System& system, const Arrays& given) {
  State state = system.rigid_state(std::vector<double>(system.joints().size(), 0.0));
  const MatrixXd& frames = of_size(given, "frames", system.n_nodes(), 12);
  for (Index k = 0; k < frames.rows(); ++k) {
    auto& [R, x] = state.frames[static_cast<std::size_t>(k)];
    const auto row = frames.row(k);
    R << row.segment<3>(0), row.segment<3>(3), row.segment<3>(6);
    x = row.segment<3>(9).transpose();
  }
  const MatrixXd& laws = of_size(given, "laws", static_cast<Index>(system.laws().size()), 2);
  for (Index k = 0; k < laws.rows(); ++k) state.laws[static_cast<std::size_t>(k)] = {laws(k, 0), laws(k, 1)};
  state.t = of_size(given, "time", 1, 1)(0, 0);
  state.s = of_size(given, "scalars", system.n_scalars(), 1);
  state.v = of_size(given, "velocities", system.n_velocities(), 1);
  state.v_dot = of_size(given, "accelerations", system.n_velocities(), 1);
  state.a = of_size(given, "algorithmic_accelerations", system.n_velocities(), 1);
  state.multipliers = of_size(given, "multipliers", system.n_constraints(), 1);
  return state;
}

/// Rows of joints: value, rate, acceleration; NaN for rates that follow from the angles.
std::vector<JointInput> joint_inputs(
    const Eigen::Ref<const Eigen::Matrix<double, -1, 3, Eigen::RowMajor>>& rows) {
  std::vector<JointInput> inputs(static_cast<std::size_t>(rows.rows()));
  for (Index j = 0; j < rows.rows(); ++j) {
    if (!std::isfinite(rows(j, 0)) || (!std::isnan(rows(j, 1)) && !rows.row(j).allFinite())) {
      throw flexarm::InvalidParameter("what joint " + std::to_string(j) + " is told must be finite");
    }
    inputs[static_cast<std::size_t>(j)] = {rows(j, 0), !std::isnan(rows(j, 1)), rows(j, 1), rows(j, 2)};
  }
  return inputs;
}

void bind_moments(py::module_& m) {
  py::class_<Linearisation, std::shared_ptr<Linearisation>>(m, "Linearisation", "Where factors were made.");
  py::class_<Moment>(m, "Moment", "An instant to go on from.")
      .def_readonly("state", &Moment::state)
      .def_readonly("steps", &Moment::steps)
      .def_property_readonly("time", [](const Moment& now) { return now.state.t; })
      .def(
          "arrays", [](const Moment& now) { return arrays(now.state); }, "The state as named arrays.")
      .def(
          "factored_arrays",
          [](const Moment& now) {
            return now.memory.factored ? arrays(now.memory.factored->state) : Arrays{};
          },
          "The state at which the kept matrix was factored; empty without.")
      .def(
          "factored_forces",
          [](const Moment& now) {
            std::map<int, Eigen::Vector3d> forces;
            if (now.memory.factored) {
              for (const auto& load : now.memory.factored->loads.points) forces[load.point] = load.force;
            }
            return forces;
          },
          "Forces at points that were part of that matrix.")
      .def(
          "counts",
          [](const Moment& now) {
            const double h = now.memory.factored ? now.memory.factored->h : 0.0;
            return py::make_tuple(now.steps, now.memory.steps, now.memory.contraction, h);
          },
          "Steps, accepted steps, contraction, step of the kept matrix.");
  m.def(
      "moment",
      [](const System& system, const Arrays& state, const Arrays& factored,
         const std::map<int, Eigen::Vector3d>& forces, const std::tuple<long, long, double, double>& counts) {
        const auto [steps, accepted, contraction, h] = counts;
        Moment now{state_of(system, state), {nullptr, contraction, accepted}, steps};
        if (!factored.empty()) {
          flexarm::integrators::check_step(h);
          Loads loads{.gravity = system.arm().gravity, .points = {}, .torques = {}};
          for (const auto& [point, force] : forces) loads.points.push_back({.point = point, .force = force});
          checks::fits(system, loads);
          now.memory.factored = std::make_shared<const Linearisation>(state_of(system, factored), loads, h);
        }
        return now;
      },
      "The moment of stored arrays.", py::arg("system"), py::arg("state"), py::arg("factored"),
      py::arg("forces"), py::arg("counts"));
}

void bind_steps(py::module_& m) {
  m.def("check_step", &flexarm::integrators::check_step,
        "Refuses a time step that is too short or not finite.", py::arg("step"));
  py::class_<Stepping>(m, "Stepping", "One step at a time.")
      .def(py::init<const System&, double, double>(), py::arg("system"), py::arg("step"), py::arg("alpha"),
           py::keep_alive<1, 2>())
      .def(
          "start",
          [](const Stepping& stepping, const Equilibrium& equilibrium) {
            checks::fits(stepping.system(), equilibrium);
            return stepping.start(equilibrium);
          },
          "The moment of an equilibrium, at t = 0.", py::arg("equilibrium"))
      .def(
          "advance",
          [](Stepping& stepping, const Moment& from,
             const Eigen::Ref<const Eigen::Matrix<double, -1, 3, Eigen::RowMajor>>& inputs,
             const std::vector<flexarm::assembly::PointLoad>& points) {
            checks::fits(stepping.system(), from.state);
            if (from.memory.factored) checks::fits(stepping.system(), from.memory.factored->state);
            checks::fits(stepping.system(), flexarm::assembly::Loads{.points = points, .torques = {}});
            return stepping.advance(from, joint_inputs(inputs), points);
          },
          "The next moment; rows of inputs: value, rate, acceleration.", py::arg("moment"), py::arg("inputs"),
          py::arg("points") = std::vector<flexarm::assembly::PointLoad>{})
      .def_property_readonly("statistics", &Stepping::statistics);
}

/// Readings of one state after another. Their consistent forces share a factorisation, and readings of the
/// same state one solution.
class Readings {
 public:
  explicit Readings(const System& system) : system_(system), forces_(system) {}

  auto joint(const py::object& state, int joint) {
    take(state);
    checks::index("joint", joint, system_.joints().size());
    const auto at = system_.joints()[static_cast<std::size_t>(joint)];
    const auto angle = [&](int s) { return s < 0 ? 0.0 : state_.s[s]; };
    const auto rate = [&](int s) { return s < 0 ? 0.0 : state_.v[system_.scalar_offset() + s]; };
    return std::tuple(angle(at.theta), rate(at.theta), angle(at.phi), rate(at.phi),
                      joint_torque(system_, state_, joint), motor_torques(system_, state_, true)[joint]);
  }

  auto point(const py::object& state, int point) {
    take(state);
    checks::index("point", point, system_.points().size());
    const auto H = system_.point_frame(state_, point);
    const auto V = system_.point_velocity(state_, point);
    return std::tuple(H.x, Eigen::Vector3d(H.R * V.head<3>()), H.R, Eigen::Vector3d(V.tail<3>()),
                      point_acceleration(system_, state_, point));
  }

 private:
  void take(const py::object& given) {
    if (given.is(given_)) return;
    const auto& state = given.cast<const State&>();
    checks::fits(system_, state);
    state_ = forces_.of(state);
    given_ = given;
  }

  const System& system_;
  ConsistentForcesIn<3> forces_;
  py::object given_;
  State state_;
};

void bind_snapshots(py::module_& m) {
  py::class_<Snapshots>(m, "Snapshots", "States looked at one by one.")
      .def_readonly("run", &Snapshots::run)
      .def_readonly("acceleration", &Snapshots::acceleration);
  m.def(
      "snapshots",
      [](const System& system, const std::vector<State>& states, const Loads& loads) {
        checks::fits(system, loads);
        for (const State& state : states) checks::fits(system, state);
        return snapshots(system, states, loads);
      },
      "What a run would have recorded in these states.", py::arg("system"), py::arg("states"),
      py::arg("loads"), py::call_guard<py::gil_scoped_release>());
  m.def(
      "displaced",
      [](const System& system, const State& state, const VectorXd& increment, const VectorXd& v,
         const VectorXd& v_dot) {
        checks::fits(system, state);
        checks::size("increment", increment.size(), system.n_free());
        checks::size("v", v.size(), system.n_free());
        checks::size("v_dot", v_dot.size(), system.n_free());
        return displaced(system, state, increment, v, v_dot);
      },
      "A state moved, with velocities and accelerations.", py::arg("system"), py::arg("state"),
      py::arg("increment"), py::arg("v"), py::arg("v_dot"));
  m.def(
      "tangents",
      [](const System& system, const Equilibrium& at) {
        checks::fits(system, at);
        const auto part = [&](double mass, double damping, double stiffness) {
          return MatrixXd(system.tangent(at.state, at.loads, {mass, damping, stiffness}, false));
        };
        return std::tuple(part(1, 0, 0), part(0, 1, 0), part(0, 0, 1),
                          MatrixXd(system.constraint_jacobian(at.state)));
      },
      "M, C, K of the free coordinates and the constraint Jacobian, dense.", py::arg("system"),
      py::arg("equilibrium"), py::call_guard<py::gil_scoped_release>());
  m.def(
      "joint_coordinates",
      [](const System& system) {
        std::vector<std::pair<int, int>> rows;
        const auto row = [&](int scalar) { return scalar < 0 ? -1 : system.scalar_offset() + scalar; };
        for (const auto& at : system.joints()) rows.emplace_back(row(at.theta), row(at.phi));
        return rows;
      },
      "Row of theta and phi of each joint among the velocities, -1 without.", py::arg("system"));
  py::class_<Readings>(m, "Readings", "Joints and points of one state after another.")
      .def(py::init<const System&>(), py::arg("system"), py::keep_alive<1, 2>())
      .def("joint", &Readings::joint,
           "Angle and rate of link and drive, torque on the child and of the motor.", py::arg("state"),
           py::arg("joint"))
      .def("point", &Readings::point,
           "Position, velocity, rotation, angular rate (own axes) and acceleration of a point.",
           py::arg("state"), py::arg("point"));
}

}  // namespace

void bind_stepping(py::module_& m) {
  bind_moments(m);
  bind_steps(m);
  bind_snapshots(m);
}
