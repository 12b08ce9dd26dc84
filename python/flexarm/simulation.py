"""Transient runs of an arm along its drives."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.parameter import Parameter, parameters
from flexarm.arrays import Floats, frozen, read_only
from flexarm.assembly import assemble, joint_values
from flexarm.drive import Drive
from flexarm.energies import NAMES as ENERGIES
from flexarm.energies import Energies, recorded_again
from flexarm.errors import InvalidParameter
from flexarm.netcdf import Contents, Variable
from flexarm.record import Record
from flexarm.result import Result, load, model_of, provenance
from flexarm.sensitivity import Redrive, Sensitivities, collected, varied

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Progress = bool | Callable[[float], object] | None
Report = Callable[[float], object] | None


@dataclass(frozen=True, eq=False, repr=False)
class Simulation(Result):
    """A run. Arrays are read-only; the first axis is the instant.

    Attributes
    ----------
    arm : Arm
        The model.
    time : ndarray, shape (n,)
        Instants [s].
    position, velocity : ndarray, shape (n, point, 3)
        Of the points, base axes [m], [m/s].
    joint_angle, joint_rate : ndarray, shape (n, joint)
        Angle theta of each link about its joint [rad, m if prismatic] and its rate.
    drive_angle, drive_rate : ndarray, shape (n, joint)
        Angle phi of each motor over the ratio, and its rate.
    joint_torque, motor_torque : ndarray, shape (n, joint)
        Torque on the child about +axis, and of the motor with rotor inertia and friction; output side [N m].
    kinetic, elastic, gravity, damped, work : ndarray, shape (n,)
        Energies, and what damping took and drives gave since the start [J]. Without `energies=True` the first
        look at one of them makes the run a second time.
    orientation, angular_rate : ndarray, shape (n, point, 4) and (n, point, 3), or None
        Quaternion x, y, z, w and rate in body axes [rad/s]; with `rotations=True`.
    section_forces : ndarray, shape (n, link, 2, 6), or None
        (N, Vy, Vz, T, My, Mz) at both ends of each link, section axes [N, N m]; with `forces=True`.
    base_wrench : ndarray, shape (n, 6), or None
        Force and moment on the base about its origin, base axes [N, N m]; with `forces=True`.
    joint_command, motor_voltage : ndarray, shape (n, joint), or None
        What controllers were asked for [rad] and the voltages they set [V], NaN where there is none; of runs
        along a command.
    sensitivities : Sensitivities or None
        Derivatives of the arrays by parameters of the model; of runs with `sensitivities=`.
    solver : dict
        Backend, step, alpha, dimension (2 where the motion lies in a plane), counts of steps, iterations and
        factorisations, seconds.
    """

    arm: Arm
    time: Floats
    position: Floats
    velocity: Floats
    joint_angle: Floats
    joint_rate: Floats
    drive_angle: Floats
    drive_rate: Floats
    joint_torque: Floats
    motor_torque: Floats
    energy_record: Energies | Callable[[], Energies]
    orientation: Floats | None = None
    angular_rate: Floats | None = None
    section_forces: Floats | None = None
    base_wrench: Floats | None = None
    joint_command: Floats | None = None
    motor_voltage: Floats | None = None
    sensitivities: Sensitivities | None = None
    solver: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def energies(self) -> Energies:
        """All energies of the run."""
        return self.energy_record() if callable(self.energy_record) else self.energy_record

    @property
    def kinetic(self) -> Floats:
        """Kinetic energy [J], shape (n,)."""
        return self.energies.kinetic

    @property
    def elastic(self) -> Floats:
        """Elastic energy of links and joints [J], shape (n,)."""
        return self.energies.elastic

    @property
    def gravity(self) -> Floats:
        """Potential energy of gravity [J], shape (n,)."""
        return self.energies.gravity

    @property
    def damped(self) -> Floats:
        """What damping and friction took since the start [J], shape (n,)."""
        return self.energies.damped

    @property
    def work(self) -> Floats:
        """Work of drives and loads since the start [J], shape (n,)."""
        return self.energies.work

    @property
    def acceleration(self) -> Floats | None:
        """Specific force at the points in body axes [m/s2], (n, point, 3), as an IMU has it: +g up at rest.

        From the derivative of a cubic spline through the velocities; None without `rotations=True`.
        """
        if self.orientation is None:
            return None
        from scipy.interpolate import CubicSpline
        from scipy.spatial.transform import Rotation

        rate = CubicSpline(self.time, self.velocity)(self.time, 1)
        specific = rate - np.asarray(self.arm.gravity)
        turn = Rotation.from_quat(self.orientation.reshape(-1, 4))
        return np.asarray(turn.inv().apply(specific.reshape(-1, 3))).reshape(specific.shape)

    def at(self, times: ArrayLike, point: str) -> Floats:
        """Positions of a point [m] at any times [s], shape (m, 3), by cubic Hermite interpolation.

        Before the run the arm rests where it starts; after its end nothing is known, and NaN stands there.

        Raises
        ------
        InvalidParameter
            If there is no such point.
        """
        from flexarm.measurement.sampling import sample

        if point not in self.points:
            raise InvalidParameter(f"there is no point {point!r}; there are {', '.join(self.points)}")
        i = self.points.index(point)
        when = np.atleast_1d(np.asarray(times, dtype=float))
        return sample(self.time, self.position[:, i], when, self.velocity[:, i])

    def contents(self) -> Contents:
        """What is stored: all arrays with units, and where they come from."""
        variables: dict[str, Variable] = {
            name: (dims, getattr(self, name), {"units": unit, "long_name": text})
            for name, (dims, unit, text) in _VARIABLES.items()
            if getattr(self, name) is not None
        }
        labels = {
            "point": self.points,
            "joint": self.joints,
            "link": [link.name for link in self.arm.links],
            "axis": ["x", "y", "z"],
            "end": ["start", "end"],
            "component": ["N", "Vy", "Vz", "T", "My", "Mz"],
            "wrench": ["Fx", "Fy", "Fz", "Mx", "My", "Mz"],
            "quaternion": ["x", "y", "z", "w"],
        }
        attributes = {"kind": "simulation", **provenance(self.arm), **self.solver}
        time: Variable = (("time",), self.time, {"units": "s"})
        contents = Contents(variables, labels, attributes, {"time": time})
        return contents if self.sensitivities is None else self.sensitivities.add_to(contents)

    @classmethod
    def load(cls, path: str | Path) -> Simulation:
        """Reads what `save` wrote.

        Raises
        ------
        InvalidFile
            If the file is not a stored run.
        """
        data = load(path, "simulation")
        arrays: dict[str, Any] = {
            name: frozen(data[name].values) for name in _VARIABLES if name in data and name not in ENERGIES
        }
        arrays["energy_record"] = Energies(*(frozen(data[name].values) for name in ENERGIES))
        solver = {name: data.attrs[name] for name in _COUNTS if name in data.attrs}
        arm = model_of(data)
        return cls(
            arm,
            frozen(data["time"].values),
            **arrays,
            sensitivities=Sensitivities.stored(arm, data),
            solver=solver,
        )

    def plot(self, ax: Axes | None = None, point: str | None = None) -> Axes:
        """Coordinates of a point (default: the last one) against time; all joints' angles without points."""
        import matplotlib.pyplot as plt

        axes = plt.subplots()[1] if ax is None else ax
        if self.points:
            name = self.points[-1] if point is None else point
            i = self.points.index(name)
            for k, axis in enumerate("xyz"):
                axes.plot(self.time, self.position[:, i, k], label=f"{name} {axis}")
            axes.set(xlabel="time [s]", ylabel="position [m]")
        else:
            axes.plot(self.time, self.joint_angle, label=list(self.joints))
            axes.set(xlabel="time [s]", ylabel="joint angle [rad]")
        axes.legend()
        return axes

    def __repr__(self) -> str:
        span = f"{self.time[0]:g} to {self.time[-1]:g} s" if len(self.time) else "no instants"
        return (
            f"<Simulation of {self.arm.name!r}: {span}, {len(self.time)} instants, "
            f"points {', '.join(self.points) or 'none'}>"
        )


_VARIABLES = {
    "position": (("time", "point", "axis"), "m", "position of points, base axes"),
    "velocity": (("time", "point", "axis"), "m/s", "velocity of points, base axes"),
    "joint_angle": (("time", "joint"), "rad", "angle of the link about its joint"),
    "joint_rate": (("time", "joint"), "rad/s", "its rate"),
    "drive_angle": (("time", "joint"), "rad", "angle of the motor over the ratio"),
    "drive_rate": (("time", "joint"), "rad/s", "its rate"),
    "joint_torque": (("time", "joint"), "N m", "torque on the child about the axis"),
    "motor_torque": (("time", "joint"), "N m", "torque of the motor times the ratio"),
    "kinetic": (("time",), "J", "kinetic energy"),
    "elastic": (("time",), "J", "elastic energy"),
    "gravity": (("time",), "J", "potential energy of gravity"),
    "damped": (("time",), "J", "taken by damping and friction since the start"),
    "work": (("time",), "J", "work of drives and loads since the start"),
    "orientation": (("time", "point", "quaternion"), "1", "orientation of the section at the points"),
    "angular_rate": (("time", "point", "axis"), "rad/s", "angular rate, body axes"),
    "section_forces": (("time", "link", "end", "component"), "N, N m", "section forces, section axes"),
    "base_wrench": (("time", "wrench"), "N, N m", "what the arm puts on the base, base axes"),
    "joint_command": (("time", "joint"), "rad", "angle that the controller is asked for"),
    "motor_voltage": (("time", "joint"), "V", "voltage of the motor"),
}
_COUNTS = (
    "drive_sha256",
    "backend",
    "step",
    "alpha",
    "dimension",
    "steps",
    "iterations",
    "factorisations",
    "halvings",
    "seconds",
)


def simulate(
    arm: Arm,
    drive: Drive | Record,
    *,
    step: float = 2e-3,
    alpha: float = -0.05,
    end: float | None = None,
    forces: bool = False,
    rotations: bool = False,
    energies: bool = False,
    sensitivities: Iterable[str] = (),
    dimension: str = "auto",
    progress: Progress = None,
) -> Simulation:
    """A run from equilibrium at rest along the drives.

    Parameters
    ----------
    arm : Arm
        The model, with its effects.
    drive : Drive or Record
        What moves the joints. A record's drive signals are smoothed by their noise, its payloads carried.
    step : float
        Time step [s].
    alpha : float
        Of the HHT method, -1/3 to 0; 0 damps nothing, negative values damp high frequencies.
    end : float, optional
        End of the run [s]; default: of the drive.
    forces, rotations : bool
        Record section forces and base reaction; orientations and angular rates of the points.
    energies : bool
        Record energies in the same run; otherwise a second run computes them when they are first asked for.
        Runs under a controller always record them.
    sensitivities : iterable of str
        Keys of parameters, such as "links.rod.material.youngs_modulus" or
        "effects.backlash.hinge.gap": what the arrays are differentiated by in the same run. The result is the
        derivative of the computed motion, not a difference of runs.
    dimension : {"auto", "plane", "space"}
        An arm that moves in a plane is computed with three coordinates a node, several times faster and with
        the same result. "space" always takes six, as do controllers; "plane" is an error
        that tells what leaves it where there is none.
    progress : bool or callable, optional
        True shows a bar on standard error; a callable gets the share done and may return False to stop.

    Returns
    -------
    Simulation

    Raises
    ------
    InvalidParameter
        If the drive does not fit the arm, step or alpha is out of range, or there is no derivative by a
        parameter.
    NotConverged
        With time, iteration and residual.
    KeyboardInterrupt
        On Ctrl-C, within a tenth of a second.

    Examples
    --------
    >>> drive = flexarm.Drive.from_samples([0, 1, 2, 3], {"hinge": [0, 0.2, 0.4, 0.4]})  # doctest: +SKIP
    >>> run = flexarm.simulate(arm, drive)  # doctest: +SKIP
    """
    if isinstance(drive, Record):
        record, carried = drive, drive.applied_to(arm)
        run = _prepared(carried, Drive.from_record(record, carried), step, alpha, end, forces, rotations)
        redrive = Redrive(
            {*record.drive, *(record.signals[name].clock for name in record.drive)},
            lambda other: _motions(other, Drive.from_record(record, other).at_inputs(other)),
        )
    else:
        run, redrive = _prepared(arm, drive, step, alpha, end, forces, rotations), None
    wanted = parameters(run.arm, sensitivities)
    run.options.record_energies = energies
    run.options.dimension = _dimension(dimension)
    if any(joint.side == "command" for joint in run.drive.joints.values()):
        from flexarm.control import simulate_closed_loop

        if wanted:
            raise InvalidParameter("a run under a controller has no derivatives yet", where="sensitivities")
        return simulate_closed_loop(
            run.arm,
            run.drive,
            step=step,
            alpha=alpha,
            end=end,
            forces=forces,
            rotations=rotations,
            progress=progress,
        )
    with reported(progress, run.arm.name) as report:
        found = _differentiated(run, wanted, redrive, report) if wanted else _plain(run, report)
    found.solver["drive_sha256"] = run.drive.sha256()
    return found


@dataclass(frozen=True)
class _Run:
    """What the core is asked for."""

    arm: Arm
    drive: Drive
    options: _core.TransientOptions

    @property
    def kinds(self) -> dict[str, _core.DriveKind]:
        return {name: joint.kind for name, joint in self.drive.joints.items()}


def _prepared(
    arm: Arm, drive: Drive, step: float, alpha: float, end: float | None, forces: bool, rotations: bool
) -> _Run:
    """The run, checked."""
    if not isinstance(drive, Drive):
        raise InvalidParameter(
            f"must be a Drive, such as Drive.from_samples gives, or a Record, got {type(drive).__name__}",
            where="drive",
        )
    moving = [joint.name for joint in arm.moving_joints]
    for name in drive.joints:
        if name not in moving:
            raise InvalidParameter(
                f"the drive moves {name!r}, which is no moving joint; there are {', '.join(moving)}"
            )
    if all(joint.side != "command" for joint in drive.joints.values()):
        drive = drive.at_inputs(arm)
    options = _core.TransientOptions()
    options.start, options.end = drive.start, drive.end if end is None else float(end)
    options.step, options.alpha = float(step), float(alpha)
    options.record_forces, options.record_rotations = forces, rotations
    return _Run(arm, drive, options)


def _dimension(name: str) -> _core.Dimension:
    known = {
        "auto": _core.Dimension.automatic,
        "plane": _core.Dimension.plane,
        "space": _core.Dimension.space,
    }
    if name not in known:
        raise InvalidParameter(f"must be one of {', '.join(known)}, got {name!r}", where="dimension")
    return known[name]


def _motions(arm: Arm, drive: Drive) -> list[_core.PiecewisePolynomial]:
    """What moves every joint; joints that nothing drives are not read."""
    hold = _core.PiecewisePolynomial.constant(0.0)
    return [
        drive.joints[joint.name].polynomial() if joint.name in drive.joints else hold for joint in arm.joints
    ]


def _plain(run: _Run, report: Report) -> Simulation:
    system, motions = assemble(run.arm, run.kinds), _motions(run.arm, run.drive)
    held = _held(run, system)
    equilibrium = _start(run, held, motions)
    if held is not system:
        equilibrium = _core.released(held, equilibrium, system)
    found = _core.simulate(system, equilibrium, motions, run.options, report)
    return _simulation(
        run.arm, found, run.options, _energies(found, system, equilibrium, motions, run.options)
    )


def _differentiated(
    run: _Run, wanted: tuple[Parameter, ...], redrive: Redrive | None, report: Report
) -> Simulation:
    """The run with the derivatives of its arrays."""
    system, motions = assemble(run.arm, run.kinds), _motions(run.arm, run.drive)
    held = _held(run, system)
    equilibrium = _start(run, held, motions)
    varied_systems, places = varied(run.arm, wanted, lambda arm: assemble(arm, run.kinds), redrive)
    if held is system:
        initial = _core.static_derivative(held, equilibrium, varied_systems, run.options.start)
    else:
        kinds = _prescribed(run)
        still, _ = varied(run.arm, wanted, lambda arm: assemble(arm, kinds), redrive)
        initial = _core.static_derivative(held, equilibrium, still, run.options.start)
        initial = _core.released_derivative(held, initial, system)
        equilibrium = _core.released(held, equilibrium, system)
    run.options.tolerance = _DIFFERENTIATED
    both = _core.simulate_differentiated(
        system, equilibrium, motions, run.options, varied_systems, initial, report
    )
    energies = _energies(both.run, system, equilibrium, motions, run.options)
    found = _simulation(run.arm, both.run, run.options, energies)
    arrays = {
        name: getattr(both.derivatives, name).T.reshape(*value.shape, len(places))
        for name in _DERIVED
        if (value := getattr(found, name)) is not None
    }
    return replace(found, sensitivities=collected(wanted, places, arrays))


_DIFFERENTIATED = 1e-13
"""Newton's tolerance: accelerations, h^2 less exact than positions, enter derivatives by masses."""

_DERIVED = (
    "position",
    "velocity",
    "joint_angle",
    "joint_rate",
    "drive_angle",
    "drive_rate",
    "joint_torque",
    "motor_torque",
    "orientation",
    "angular_rate",
    "section_forces",
    "base_wrench",
)
"""Arrays of a run that have derivatives."""


def _prescribed(run: _Run) -> dict[str, _core.DriveKind]:
    """Joints whose angle is told from the start; motors driven by torque are held until then."""
    return {name: joint.kind for name, joint in run.drive.joints.items() if joint.side != "torque"}


def _held(run: _Run, system: _core.System) -> _core.System:
    kinds = _prescribed(run)
    return system if len(kinds) == len(run.drive.joints) else assemble(run.arm, kinds)


def _start(run: _Run, held: _core.System, motions: list[_core.PiecewisePolynomial]) -> _core.Equilibrium:
    """Equilibrium under the first drive values; motors driven by torque stand where they rest until then."""
    told = _prescribed(run)
    first = {
        joint.name: motion(run.drive.start)[0]
        for joint, motion in zip(run.arm.joints, motions, strict=True)
        if joint.name in told
    }
    values = joint_values(run.arm, {**run.drive.rest, **first})
    return _core.static_equilibrium(held, values, _core.Loads(gravity=np.array(run.arm.gravity)))


@contextmanager
def reported(progress: Progress, name: str) -> Iterator[Callable[[float], object] | None]:
    """The callback for the core: a bar, the caller's own, or none."""
    if progress is None or progress is False or callable(progress):
        yield progress if callable(progress) else None
        return
    from shutil import get_terminal_size

    from tqdm import tqdm

    columns, rows = get_terminal_size()  # tqdm draws nothing at a terminal that tells no size
    form = "{desc}: {percentage:3.0f}%|{bar}| {elapsed}"
    with tqdm(total=100, desc=name, bar_format=form, ncols=columns, nrows=rows) as bar:

        def show(done: float) -> None:
            bar.update(100 * done - bar.n)

        yield show
        bar.update(100 - bar.n)


def _energies(
    found: _core.Transient,
    system: _core.System,
    equilibrium: _core.Equilibrium,
    motions: list[_core.PiecewisePolynomial],
    options: _core.TransientOptions,
) -> Energies | Callable[[], Energies]:
    """Recorded, or how to get them."""
    if options.record_energies:
        return Energies.of(found)
    return recorded_again(system, equilibrium, motions, options, float(found.time[-1]))


def _simulation(
    arm: Arm,
    run: _core.Transient,
    options: _core.TransientOptions,
    energies: Energies | Callable[[], Energies],
) -> Simulation:
    """The core's columns as arrays with the instant first; they stay where the core wrote them."""
    n, p, links = len(run.time), len(arm.points), len(arm.links)

    def columns(name: str, *shape: int) -> Floats | None:
        block = getattr(run, name)
        return read_only(block.T.reshape(n, *shape)) if block.size or 0 in shape else None

    joints = {
        name: columns(name, len(arm.joints))
        for name in ("joint_angle", "joint_rate", "drive_angle", "drive_rate", "joint_torque", "motor_torque")
    }
    arrays: dict[str, Any] = {
        **joints,
        "energy_record": energies,
        "position": columns("position", p, 3),
        "velocity": columns("velocity", p, 3),
        "section_forces": columns("section_forces", links, 2, 6),
        "base_wrench": columns("base_wrench", 6),
    }
    if options.record_rotations:
        arrays |= {"orientation": columns("orientation", p, 4), "angular_rate": columns("angular_rate", p, 3)}
    counts = run.statistics
    solver = {
        "backend": _core.build_info().solver,
        "step": options.step,
        "alpha": options.alpha,
        "dimension": run.dimension,
        "steps": counts.steps,
        "iterations": counts.iterations,
        "factorisations": counts.factorisations,
        "halvings": counts.halvings,
        "seconds": run.seconds,
    }
    return Simulation(arm, read_only(run.time), **arrays, solver=solver)
