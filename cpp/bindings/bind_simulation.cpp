#include <pybind11/eigen.h>
#include <pybind11/functional.h>
#include <pybind11/native_enum.h>
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "checks.hpp"
#include "flexarm/sensitivity/differentiated_run.hpp"
#include "flexarm/sensitivity/differentiated_sampled_run.hpp"
#include "flexarm/sensitivity/modal_derivative.hpp"
#include "flexarm/simulation/modal.hpp"
#include "flexarm/simulation/reactions.hpp"
#include "flexarm/simulation/sampled_run.hpp"
#include "flexarm/simulation/side_by_side.hpp"
#include "flexarm/simulation/transient.hpp"

namespace py = pybind11;
using namespace flexarm::sensitivity;
using namespace flexarm::simulation;

namespace {

/// Takes the interpreter's lock now and then for signals (Ctrl-C) and the caller's progress, which must
/// outlive it.
Progress polled(const py::object& progress) {
  return [&progress](double done) {
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    return progress.is_none() || !progress(done).is(py::bool_(false));
  };
}

/// Runs without the interpreter's lock.
Transient run(const System& system, const Equilibrium& equilibrium,
              const std::vector<PiecewisePolynomial>& drives, const TransientOptions& options,
              const py::object& progress) {
  const Progress poll = polled(progress);
  checks::fits(system, equilibrium);
  const py::gil_scoped_release unlock;
  return simulate(system, equilibrium, drives, options, poll);
}

/// Runs side by side; None for an arm that is to run alone.
std::vector<std::optional<Transient>> run_side_by_side(
    const std::vector<std::pair<std::shared_ptr<System>, Equilibrium>>& arms,
    const std::vector<PiecewisePolynomial>& drives, const TransientOptions& options,
    const py::object& progress) {
  const Progress poll = polled(progress);
  std::vector<Variant> variants;
  for (const auto& [system, equilibrium] : arms) {
    checks::fits(*system, equilibrium);
    variants.push_back({system.get(), &equilibrium});
  }
  const py::gil_scoped_release unlock;
  return simulate_side_by_side(variants, drives, options, poll);
}

/// Two models of the system, with p raised and lowered, and what drives them where that depends on p.
struct Varied {
  std::shared_ptr<System> plus, minus;
  double up, down;
  std::vector<PiecewisePolynomial> drives_plus, drives_minus;  // empty: as the system's
};

/// @param drives the system's own; needed where a moment on the base may depend on the parameter.
std::vector<Variation> variations(const State& state, const std::vector<Varied>& varied,
                                  const std::vector<PiecewisePolynomial>& drives = {}) {
  std::vector<Variation> found;
  for (const Varied& p : varied) {
    for (const System* system : {p.plus.get(), p.minus.get()}) checks::fits(*system, state);
    for (const auto* own : {&p.drives_plus, &p.drives_minus, &drives}) {
      if (!own->empty())
        checks::size("drives", static_cast<Eigen::Index>(own->size()),
                     static_cast<Eigen::Index>(p.plus->joints().size()));
    }
    checks::size("drives with the parameter down", static_cast<Eigen::Index>(p.drives_minus.size()),
                 static_cast<Eigen::Index>(p.drives_plus.size()));
    Variation one{p.plus.get(), p.minus.get(), p.up, p.down, {}, {}};
    if (!p.drives_plus.empty()) {
      one.drive_plus = drives_of_joints(*p.plus, state, p.drives_plus);
      one.drive_minus = drives_of_joints(*p.minus, state, p.drives_minus);
    } else if (!drives.empty() && !p.plus->pedestal().thetas.empty()) {
      one.drive_plus = drives_of_joints(*p.plus, state, drives);
      one.drive_minus = drives_of_joints(*p.minus, state, drives);
    }
    found.push_back(std::move(one));
  }
  return found;
}

DifferentiatedRun run_differentiated(const System& system, const Equilibrium& equilibrium,
                                     const std::vector<PiecewisePolynomial>& drives,
                                     const TransientOptions& options, const std::vector<Varied>& varied,
                                     const StateDerivative& initial, const py::object& progress) {
  const Progress poll = polled(progress);
  checks::fits(system, equilibrium);
  checks::fits(system, initial, static_cast<Eigen::Index>(varied.size()));
  const py::gil_scoped_release unlock;
  return simulate(system, equilibrium, drives, options, variations(equilibrium.state, varied, drives),
                  initial, poll);
}

/// What a run says of one of its points.
template <auto read>
auto of_point(const SampledRun& run, int point) {
  checks::index("point", point, run.system().points().size());
  return (run.*read)(point);
}

void bind_statics(py::module_& m) {
  py::class_<Equilibrium>(m, "Equilibrium", "An equilibrium at rest.")
      .def_readonly("state", &Equilibrium::state)
      .def_readonly("iterations", &Equilibrium::iterations)
      .def_readonly("load_steps", &Equilibrium::load_steps)
      .def_readonly("residual", &Equilibrium::residual, "Largest unbalanced force [N].");
  m.def(
      "static_equilibrium",
      [](const System& system, const std::vector<double>& joint_values, const Loads& loads, double time) {
        checks::fits(system, loads);
        for (const double value : joint_values) {
          if (!std::isfinite(value)) throw flexarm::InvalidParameter("values of joints must be finite");
        }
        return static_equilibrium(system, joint_values, loads, {.time = time});
      },
      "Equilibrium of the loaded arm, drives held, at a time.", py::arg("system"), py::arg("joint_values"),
      py::arg("loads"), py::arg("time") = 0.0, py::call_guard<py::gil_scoped_release>());
  py::class_<Modes>(m, "Modes", "Modes about an equilibrium.")
      .def_readonly("frequency_hz", &Modes::frequency_hz)
      .def_readonly("damping_ratio", &Modes::damping_ratio)
      .def_readonly("damped_frequency_hz", &Modes::damped_frequency_hz)
      .def_readonly("shapes", &Modes::shapes)
      .def_readonly("iterations", &Modes::iterations);
  m.def(
      "modes",
      [](const System& system, const Equilibrium& equilibrium, int count) {
        checks::fits(system, equilibrium);
        return modes(system, equilibrium, count);
      },
      "Lowest modes about an equilibrium.", py::arg("system"), py::arg("equilibrium"), py::arg("count"),
      py::call_guard<py::gil_scoped_release>());

  m.def(
      "closure_force",
      [](const System& system, const State& state, int closure) {
        checks::fits(system, state);
        checks::index("closure", closure, system.closures().size());
        return closure_force(system, state, static_cast<std::size_t>(closure)).wrench;
      },
      "Force and moment that a closure puts on its link b at its place there, base axes.", py::arg("system"),
      py::arg("state"), py::arg("closure"));
  m.def(
      "closure_indeterminacy",
      [](const System& system, const State& state, int closure) {
        checks::fits(system, state);
        checks::index("closure", closure, system.closures().size());
        return system.closures().indeterminacy(static_cast<std::size_t>(closure), state.frames);
      },
      "Largest change of each entry of closure_force by unit forces that the loops do not tell.",
      py::arg("system"), py::arg("state"), py::arg("closure"));
  py::class_<SectionForces>(m, "SectionForces", "Section forces at both ends of a beam.")
      .def_readonly("start", &SectionForces::start)
      .def_readonly("end", &SectionForces::end);
  m.def(
      "section_forces",
      [](const System& system, const State& state, const Loads& loads, int link) {
        checks::fits(system, state);
        checks::fits(system, loads);
        checks::index("link", link, system.meshes().size());
        return section_forces(system, state, loads, link);
      },
      "Section forces of a link.", py::arg("system"), py::arg("state"), py::arg("loads"), py::arg("link"));
  m.def(
      "joint_torque",
      [](const System& system, const State& state, int joint) {
        checks::fits(system, state);
        checks::index("joint", joint, system.joints().size());
        return joint_torque(system, state, joint);
      },
      "Torque on the child about the axis.", py::arg("system"), py::arg("state"), py::arg("joint"));
  m.def(
      "motor_torques",
      [](const System& system, const State& state, bool friction) {
        checks::fits(system, state);
        return motor_torques(system, state, friction);
      },
      "Motor torques, output-referred.", py::arg("system"), py::arg("state"), py::arg("friction"));
  m.def(
      "base_wrench",
      [](const System& system, const State& state) {
        checks::fits(system, state);
        return base_wrench(system, state);
      },
      "What the arm puts on the base.", py::arg("system"), py::arg("state"));
  m.def(
      "joint_angles",
      [](const System& system, const State& state) {
        checks::fits(system, state);
        Eigen::VectorXd theta = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(system.joints().size()));
        for (std::size_t j = 0; j < system.joints().size(); ++j) {
          if (system.joints()[j].theta >= 0)
            theta[static_cast<Eigen::Index>(j)] = state.s[system.joints()[j].theta];
        }
        return theta;
      },
      "Angle of every link about its joint.", py::arg("system"), py::arg("state"));
}

void bind_transient(py::module_& m) {
  using flexarm::integrators::HhtStatistics;
  py::class_<HhtStatistics>(m, "HhtStatistics", "Counts of a run.")
      .def_readonly("steps", &HhtStatistics::steps)
      .def_readonly("iterations", &HhtStatistics::iterations)
      .def_readonly("factorisations", &HhtStatistics::factorisations)
      .def_readonly("halvings", &HhtStatistics::halvings);
  py::native_enum<Dimension>(m, "Dimension", "enum.Enum")
      .value("automatic", Dimension::automatic)
      .value("plane", Dimension::plane)
      .value("space", Dimension::space)
      .finalize();
  py::class_<TransientOptions>(m, "TransientOptions", "Options of a run.")
      .def(py::init<>())
      .def_readwrite("start", &TransientOptions::start)
      .def_readwrite("end", &TransientOptions::end)
      .def_readwrite("step", &TransientOptions::step)
      .def_readwrite("alpha", &TransientOptions::alpha)
      .def_readwrite("tolerance", &TransientOptions::tolerance)
      .def_readwrite("dimension", &TransientOptions::dimension)
      .def_readwrite("record_points", &TransientOptions::record_points)
      .def_readwrite("record_rotations", &TransientOptions::record_rotations)
      .def_readwrite("record_joints", &TransientOptions::record_joints)
      .def_readwrite("record_energies", &TransientOptions::record_energies)
      .def_readwrite("record_forces", &TransientOptions::record_forces)
      .def_readwrite("consistent_forces", &TransientOptions::consistent_forces);
  py::class_<Transient>(m, "Transient", "A run: one column an instant.")
      .def_readonly("time", &Transient::time)
      .def_readonly("position", &Transient::position)
      .def_readonly("velocity", &Transient::velocity)
      .def_readonly("orientation", &Transient::orientation)
      .def_readonly("angular_rate", &Transient::angular_rate)
      .def_readonly("joint_angle", &Transient::joint_angle)
      .def_readonly("joint_rate", &Transient::joint_rate)
      .def_readonly("drive_angle", &Transient::drive_angle)
      .def_readonly("drive_rate", &Transient::drive_rate)
      .def_readonly("joint_torque", &Transient::joint_torque)
      .def_readonly("motor_torque", &Transient::motor_torque)
      .def_readonly("kinetic", &Transient::kinetic)
      .def_readonly("elastic", &Transient::elastic)
      .def_readonly("gravity", &Transient::gravity)
      .def_readonly("damped", &Transient::damped)
      .def_readonly("work", &Transient::work)
      .def_readonly("section_forces", &Transient::section_forces)
      .def_readonly("base_wrench", &Transient::base_wrench)
      .def_readonly("statistics", &Transient::statistics)
      .def_readonly("final_state", &Transient::final_state)
      .def_readonly("dimension", &Transient::dimension, "2 if the run was computed in a plane, else 3.")
      .def_readonly("seconds", &Transient::seconds)
      .def_readonly("cancelled", &Transient::cancelled);
  m.def("simulate", &run, "A run from equilibrium along drives.", py::arg("system"), py::arg("equilibrium"),
        py::arg("drives"), py::arg("options"), py::arg("progress") = py::none());
  m.def("lanes", &arms_side_by_side, "Arms that this processor computes side by side; 0: none.");
  m.def("simulate_side_by_side", &run_side_by_side,
        "Runs of (system, equilibrium) along the same drives; None for each that is to run alone.",
        py::arg("arms"), py::arg("drives"), py::arg("options"), py::arg("progress") = py::none());
  py::class_<StateDerivative>(m, "StateDerivative", "Derivative of a state, one column a parameter.")
      .def_readonly("position", &StateDerivative::position)
      .def_readwrite("velocity", &StateDerivative::velocity);
  py::class_<Varied>(m, "Varied", "Models with a parameter a little up and a little down.")
      .def(py::init<std::shared_ptr<System>, std::shared_ptr<System>, double, double,
                    std::vector<PiecewisePolynomial>, std::vector<PiecewisePolynomial>>(),
           py::arg("plus").none(false), py::arg("minus").none(false), py::arg("up"), py::arg("down"),
           py::arg("drives_plus") = std::vector<PiecewisePolynomial>{},
           py::arg("drives_minus") = std::vector<PiecewisePolynomial>{})
      .def_readonly("plus", &Varied::plus)
      .def_readonly("minus", &Varied::minus)
      .def_readonly("up", &Varied::up)
      .def_readonly("down", &Varied::down);
  py::class_<DifferentiatedRun>(m, "DifferentiatedRun", "A run and the derivatives of its columns.")
      .def_readonly("run", &DifferentiatedRun::run)
      .def_readonly("derivatives", &DifferentiatedRun::derivatives,
                    "As the run's columns, but one row for each row and parameter.");
  m.def(
      "static_derivative",
      [](const System& system, Equilibrium equilibrium, const std::vector<Varied>& varied, double t) {
        checks::fits(system, equilibrium);
        equilibrium.state.t = equilibrium.state.start = t;
        return static_derivative(system, equilibrium, variations(equilibrium.state, varied));
      },
      "Derivative of an equilibrium with drives as they are at time t.", py::arg("system"),
      py::arg("equilibrium"), py::arg("varied"), py::arg("t") = 0.0,
      py::call_guard<py::gil_scoped_release>());
  m.def(
      "in_motion",
      [](Equilibrium start, const StateDerivative& along) {
        checks::size("rows of the derivative", along.position.rows(), start.state.v.size());
        checks::index("parameter", 0, static_cast<std::size_t>(along.size()));
        start.state.v = along.position.col(0);
        return start;
      },
      "The equilibrium, passed with the velocities of its derivative by the first parameter.",
      py::arg("equilibrium"), py::arg("along"));
  m.def(
      "frequency_derivatives",
      [](const System& system, const Equilibrium& equilibrium, int count, const std::vector<Varied>& varied) {
        checks::fits(system, equilibrium);
        return frequency_derivatives(system, equilibrium, count, variations(equilibrium.state, varied));
      },
      "df/dp of the lowest modes, (mode, parameter) [Hz per unit].", py::arg("system"),
      py::arg("equilibrium"), py::arg("count"), py::arg("varied"), py::call_guard<py::gil_scoped_release>());
  m.def(
      "moved",
      [](const System& system, const State& state, const StateDerivative& derivative, Eigen::Index k,
         double amount) {
        checks::fits(system, state);
        checks::fits(system, derivative, derivative.size());
        checks::index("parameter", k, static_cast<std::size_t>(derivative.size()));
        return moved(system, state, derivative, k, amount);
      },
      "The state moved along its derivative by an amount of the k-th parameter.", py::arg("system"),
      py::arg("state"), py::arg("derivative"), py::arg("k"), py::arg("amount"));
  m.def(
      "released_derivative",
      [](const System& held, const StateDerivative& derivative, const System& system) {
        checks::same_arm(held, system);
        checks::fits(held, derivative, derivative.size());
        return released(held, derivative, system);
      },
      "The derivative with motors let go.", py::arg("held"), py::arg("derivative"), py::arg("system"));
  m.def("simulate_differentiated", &run_differentiated, "A run with derivatives.", py::arg("system"),
        py::arg("equilibrium"), py::arg("drives"), py::arg("options"), py::arg("varied"), py::arg("initial"),
        py::arg("progress") = py::none());
  m.def(
      "released",
      [](const System& held, const Equilibrium& equilibrium, const System& system) {
        checks::same_arm(held, system);
        checks::fits(held, equilibrium);
        return released(held, equilibrium, system);
      },
      "The equilibrium with motors let go.", py::arg("held"), py::arg("equilibrium"), py::arg("system"));
  py::class_<SampledRun>(m, "SampledRun", "A run under a sampled controller.")
      .def(py::init([](const System& system, const Equilibrium& equilibrium,
                       std::vector<PiecewisePolynomial> drives, const TransientOptions& options) {
             checks::fits(system, equilibrium);
             return std::make_unique<SampledRun>(system, equilibrium, std::move(drives), options);
           }),
           py::arg("system"), py::arg("equilibrium"), py::arg("drives"), py::arg("options"),
           py::keep_alive<1, 2>())
      .def("advance", &SampledRun::advance, "Steps with motor torques held.", py::arg("motor_torque"),
           py::arg("n_steps"))
      .def_property_readonly("done", &SampledRun::done)
      .def_property_readonly("time", &SampledRun::time)
      .def_property_readonly("state", [](const SampledRun& run) { return run.state(); })
      .def_property_readonly("drive_angles", &SampledRun::drive_angles)
      .def_property_readonly("drive_rates", &SampledRun::drive_rates)
      .def_property_readonly("joint_angles", &SampledRun::joint_angles)
      .def_property_readonly("joint_rates", &SampledRun::joint_rates)
      .def("point_position", &of_point<&SampledRun::point_position>, py::arg("point"))
      .def("point_velocity", &of_point<&SampledRun::point_velocity>, py::arg("point"))
      .def_property_readonly("statistics", &SampledRun::statistics)
      .def("result", &SampledRun::result, "What was recorded so far.");
  using Differentiated = DifferentiatedSampledRun;
  py::class_<Differentiated>(m, "DifferentiatedSampledRun",
                             "A run under a sampled controller, with derivatives.")
      .def(py::init([](const System& system, const Equilibrium& equilibrium,
                       const std::vector<PiecewisePolynomial>& drives, const TransientOptions& options,
                       const std::vector<Varied>& varied, const StateDerivative& initial) {
             checks::fits(system, equilibrium);
             checks::fits(system, initial, static_cast<Eigen::Index>(varied.size()));
             return std::make_unique<Differentiated>(system, equilibrium, drives, options,
                                                     variations(equilibrium.state, varied, drives), initial);
           }),
           py::arg("system"), py::arg("equilibrium"), py::arg("drives"), py::arg("options"),
           py::arg("varied"), py::arg("initial"), py::keep_alive<1, 2>(), py::keep_alive<1, 6>())
      .def("advance", &Differentiated::advance, "Steps with motor torques and their derivatives held.",
           py::arg("motor_torque"), py::arg("torque_slopes"), py::arg("n_steps"))
      .def_property_readonly("run", &Differentiated::run, "The run itself, to look at.")
      .def_property_readonly("drive_angle_slopes", &Differentiated::drive_angle_slopes)
      .def_property_readonly("drive_rate_slopes", &Differentiated::drive_rate_slopes)
      .def_property_readonly("joint_angle_slopes", &Differentiated::joint_angle_slopes)
      .def_property_readonly("joint_rate_slopes", &Differentiated::joint_rate_slopes)
      .def(
          "point_position_slopes",
          [](const Differentiated& run, int point) {
            checks::index("point", point, run.run().system().points().size());
            return run.point_position_slopes(point);
          },
          py::arg("point"))
      .def("result", &Differentiated::result, "What was recorded so far.");
}

}  // namespace

void bind_simulation(py::module_& m) {
  bind_statics(m);
  bind_transient(m);
}
