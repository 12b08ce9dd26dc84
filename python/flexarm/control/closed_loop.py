"""Transient of an arm under sampled controllers.

At every sample a controller reads its sensors and sets a torque, which is held until the next one while the
finite elements go on in equal steps. Samples of all controllers fall on a common grid.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil, isclose, pi
from time import perf_counter

import numpy as np

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.controller import Controller
from flexarm.arm.joint import shaft_ratio
from flexarm.arm.parameter import Parameter, parameters
from flexarm.arm.sizes import LONGEST
from flexarm.arrays import Floats, read_only
from flexarm.control.back_emf import without_losses
from flexarm.control.controlled import ControlledArm
from flexarm.control.differentiated import Differentiation, commanded_at
from flexarm.control.dual import Real, slopes_of, value_of
from flexarm.control.loop import ControlLoop
from flexarm.control.plant import Plant
from flexarm.drive import Drive
from flexarm.errors import InvalidParameter, NotConverged
from flexarm.record import Record
from flexarm.record.step_limit import check_step_count
from flexarm.simulation.energies import Energies
from flexarm.simulation.from_core import simulation_of
from flexarm.simulation.progress import Progress, reported
from flexarm.simulation.simulation import Simulation
from flexarm.simulation.solve import DIFFERENTIATED

Schedule = Mapping[str, Callable[[float], Controller]]


def simulate_closed_loop(
    arm: Arm,
    drive: Drive | Record,
    *,
    step: float = 1e-3,
    alpha: float = -0.05,
    end: float | None = None,
    forces: bool = False,
    rotations: bool = False,
    schedule: Schedule | None = None,
    sensitivities: Iterable[str] = (),
    progress: Progress = None,
) -> Simulation:
    """Simulate from equilibrium at rest along commands.

    Until the start the motors hold the arm where its encoders show the first command; an integral part starts
    there.

    Parameters
    ----------
    arm : Arm
        The model, with a controller for every commanded joint.
    drive : Drive or Record
        Joints whose side is "command" follow through their controllers, others as in `flexarm.simulate`.
    step : float
        Longest time step [s]; the step is the largest part of the shortest sample time that is no longer.
    alpha, end, forces, rotations, progress
        As in `flexarm.simulate`.
    schedule : dict of str to callable, optional
        Controller of a joint at a time [s], for gains that change in a run; joint, type, deflection, sample
        time and torque limit stay. Such a run has no derivatives.
    sensitivities : iterable of str
        As in `flexarm.simulate`. Parameters of motors, gears and of effects on the sensors in the loop act
        through the loop too; gains and sample times are no parameters. What a limit holds has the derivative
        of the side on which it is, and rounding by an encoder's steps is left out, for it has none.

    Returns
    -------
    Simulation
        With `joint_command` and, where the model has a motor, `motor_voltage`. `motor_torque` is the torque
        on the rotor, `work` and `damped` are without the motor's electrical losses.

    Raises
    ------
    InvalidParameter
        If a commanded joint has no controller, sample times have no common grid, a schedule changes more than
        gains, or there is no derivative by a parameter.
    NotConverged
        With time, iteration and residual; also if a motor runs a turn (a joint that slides `LONGEST`) farther
        from its command than commands range, for its controller diverges.

    Examples
    --------
    >>> command = Drive.from_samples([0, 1, 2], {"hinge": [0, 0.1, 0.1]}, side="command")  # doctest: +SKIP
    >>> run = simulate_closed_loop(arm, command)  # doctest: +SKIP
    """
    _core.check_step(step)
    record = drive if isinstance(drive, Record) else None
    if isinstance(drive, Record):
        arm, drive = drive.applied_to(arm), Drive.from_record(drive, drive.applied_to(arm))
    task = ControlledArm.of(arm, drive)
    grid = SampleGrid.of(task.controllers, step)
    options = _core.TransientOptions()
    options.start, options.end = drive.start, drive.end if end is None else float(end)
    options.step, options.alpha = grid.step, float(alpha)
    check_step_count(options.start, options.end, options.step)
    options.record_energies, options.record_forces, options.record_rotations = True, forces, rotations
    wanted = parameters(arm, sensitivities)
    if wanted and schedule:
        what = "a run whose gains change by a schedule has no derivatives; leave one of the two out"
        raise InvalidParameter(what, where="sensitivities")
    began = perf_counter()
    if wanted:
        found = _differentiated(task, wanted, record, grid, options, progress)
    else:
        found = _alone(task, schedule or {}, grid, options, progress)
    found.solver["seconds"] = perf_counter() - began
    return found


def _alone(
    task: ControlledArm,
    schedule: Schedule,
    grid: SampleGrid,
    options: _core.TransientOptions,
    progress: Progress,
) -> Simulation:
    """Simulate without derivatives."""
    equilibrium = task.at_rest(options.start)
    holding = _core.motor_torques(task.held, equilibrium.state, False)
    loops = {
        name: ControlLoop.of(task.arm, controller, holding, schedule.get(name))
        for name, controller in task.controllers.items()
    }
    start = _core.released(task.held, equilibrium, task.system)
    run = _core.SampledRun(task.system, start, task.motions, options)
    times = grid.times(options)
    commands = {name: task.drive.joints[name](times).tolist() for name in loops}
    voltage, _ = _sampled(task, Plant(run), loops, commands, grid, progress)
    return _finished(task, run.result(), options, grid, voltage)


def _differentiated(
    task: ControlledArm,
    wanted: tuple[Parameter, ...],
    record: Record | None,
    grid: SampleGrid,
    options: _core.TransientOptions,
    progress: Progress,
) -> Simulation:
    """Simulate with derivatives."""
    options.tolerance = DIFFERENTIATED
    by = Differentiation(task, wanted, options.start, record)
    plant, loops, times = by.plant(options), by.loops(), grid.times(options)
    commands = {name: by.commands(name, times) for name in loops}
    voltage, slopes = _sampled(task, plant, loops, commands, grid, progress)
    both = plant.result()
    found = _finished(task, both.run, options, grid, voltage)
    return replace(
        found, sensitivities=by.collected(found, both.derivatives, grid.held(slopes, len(found.time)))
    )


def _sampled(
    task: ControlledArm,
    plant: Plant,
    loops: Mapping[str, ControlLoop],
    commands: Mapping[str, Sequence[Real]],
    grid: SampleGrid,
    progress: Progress,
) -> tuple[Floats, Floats]:
    """Take the run to its end; return the voltages [V] of every tick and joint and their derivatives.

    Where there is no voltage they are NaN.
    """
    look = 64  # samples between two reports of progress
    count = min(len(samples) for samples in commands.values())
    torque: list[Real] = [0.0] * len(task.arm.joints)
    voltage = np.full((count, len(torque)), np.nan)
    slopes = np.full((*voltage.shape, plant.n_parameters), np.nan)
    ranges = {name: float(np.ptp([*map(value_of, samples)])) for name, samples in commands.items()}
    with reported(progress, task.arm.name) as report:
        for k in range(count):
            for name, loop in loops.items():
                if k % grid.every[name] == 0:
                    volts, torque[loop.joint] = loop.sample(plant, commands[name][k])
                    held = slice(k, k + grid.every[name])
                    voltage[held, loop.joint] = value_of(volts)
                    slopes[held, loop.joint] = slopes_of(volts, plant.n_parameters)
            commanded = {name: value_of(samples[k]) for name, samples in commands.items()}
            require_stable(task.arm, loops, plant, commanded, ranges)
            try:
                plant.advance(torque, grid.substeps)
            except NotConverged as error:
                raise add_controller_states(error, task.arm, loops, plant, commanded) from None
            if report is not None and k % look == 0 and report(k / count) is False:
                break
    slopes[np.isnan(voltage)] = np.nan
    return voltage, slopes


def _finished(
    task: ControlledArm,
    transient: _core.Transient,
    options: _core.TransientOptions,
    grid: SampleGrid,
    voltage: Floats,
) -> Simulation:
    """Return the run with its commands, and the voltages [V] of every step."""
    run = without_losses(simulation_of(task.arm, transient, options, Energies.of(transient)), task.losses)
    command = np.full(run.drive_angle.shape, np.nan)
    for name in task.controllers:
        command[:, run.joints.index(name)] = task.drive.joints[name](commanded_at(run.time))
    return replace(
        run, joint_command=read_only(command), motor_voltage=read_only(grid.held(voltage, len(run.time)))
    )


@dataclass(frozen=True)
class SampleGrid:
    """The sample instants of controllers, and the equal steps in between."""

    tick: float
    """Shortest sample time [s]."""
    every: Mapping[str, int]
    """Ticks from sample to sample, by joint."""
    substeps: int
    """Steps in a tick."""

    @classmethod
    def of(cls, controllers: Mapping[str, Controller], longest: float) -> SampleGrid:
        """Return the grid of some controllers; its step is the largest part of a tick up to `longest` [s].

        Raise InvalidParameter if the sample times have no common grid.
        """
        tick = min(controller.sample_time for controller in controllers.values())
        every = {name: _multiple(controller, tick) for name, controller in controllers.items()}
        return cls(tick, every, max(1, ceil(tick / longest - 1e-9)))

    @property
    def step(self) -> float:
        """Time step [s]."""
        return self.tick / self.substeps

    def times(self, options: _core.TransientOptions) -> Floats:
        """Return when ticks of a run begin [s], a little late so that a change at a tick counts."""
        count = ceil((options.end - options.start) / self.tick - 1e-9)
        return options.start + self.tick * (np.arange(count, dtype=np.float64) + 1e-6)

    def held(self, ticks: Floats, count: int) -> Floats:
        """Repeat values held over ticks, shape (tick, ...), at the first `count` instants of the run."""
        return np.concatenate([np.repeat(ticks, self.substeps, axis=0), ticks[-1:]])[:count]


def _multiple(controller: Controller, tick: float) -> int:
    ratio = controller.sample_time / tick
    if not isclose(ratio, round(ratio), rel_tol=1e-9):
        what = f"must be a multiple of the shortest sample time, {tick:g} s, got {controller.sample_time:g} s"
        raise InvalidParameter(what, where=f"controllers.{controller.joint}.sample_time")
    return round(ratio)


def require_stable(
    arm: Arm,
    loops: Mapping[str, ControlLoop],
    plant: Plant,
    commanded: Mapping[str, float],
    ranges: Mapping[str, float],
) -> None:
    """Raise NotConverged if a motor deviates from its command by more than the command range plus one turn.

    A slide has `LONGEST` instead of the turn.
    """
    for name, error, unit in _errors(arm, loops, plant, commanded):
        limit = ranges[name] + (LONGEST if unit == "m" else 2 * pi * shaft_ratio(name, arm.gears))
        if not abs(error) <= limit:  # also NaN
            raise NotConverged(
                f"the controller of joint {name!r} diverges: at t = {plant.time:.6g} s its motor stands "
                f"{abs(error):.3g} {unit} from its command, allowed are {limit:.3g} {unit}; are its gains "
                "and sample time those of the machine, and is the torque enough?",
                time=plant.time,
            )


def add_controller_states(
    failure: NotConverged,
    arm: Arm,
    loops: Mapping[str, ControlLoop],
    plant: Plant,
    commanded: Mapping[str, float],
) -> NotConverged:
    """Return a failure of the time step that says what the controllers did then."""
    states = [
        f"the motor of {name!r} is {abs(error):.2g} {unit} from its command and moves at "
        f"{value_of(plant.rate(loops[name].joint, output=False)):.3g} {unit}/s"
        for name, error, unit in _errors(arm, loops, plant, commanded)
    ]
    what = f"{failure}; under its controller {', '.join(states)}"
    return NotConverged(what, time=failure.time, iteration=failure.iteration, residual=failure.residual)


def _errors(
    arm: Arm, loops: Mapping[str, ControlLoop], plant: Plant, commanded: Mapping[str, float]
) -> Iterator[tuple[str, float, str]]:
    """Yield joint, command minus motor angle (output-referred), and unit."""
    for name, loop in loops.items():
        error = commanded[name] - value_of(plant.angle(loop.joint, output=False))
        yield name, error, "m" if arm.joint(name).type == "prismatic" else "rad"
