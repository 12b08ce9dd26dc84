"""Transient of an arm under sampled controllers.

At every sample a controller reads its sensors and sets a torque, which is held until the next one while the
finite elements go on in equal steps. Samples of all controllers fall on a common grid.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import isnan
from time import perf_counter

import numpy as np

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.controller import Controller
from flexarm.arrays import Floats, read_only
from flexarm.assembly import assemble, joint_values
from flexarm.control.back_emf import losses_of, with_losses, without_losses
from flexarm.control.grid import SampleGrid
from flexarm.control.loop import Loop
from flexarm.control.sensing import Sensing
from flexarm.drive import Drive
from flexarm.errors import InvalidParameter
from flexarm.simulation import Progress, Simulation, reported
from flexarm.simulation.energies import Energies
from flexarm.simulation.from_core import simulation_of
from flexarm.simulation.prepared import motions
from flexarm.simulation.progress import Report

Schedule = Mapping[str, Callable[[float], Controller]]
_LOOK = 64
"""Samples between two reports of progress."""


def simulate_closed_loop(
    arm: Arm,
    drive: Drive,
    *,
    step: float = 1e-3,
    alpha: float = -0.05,
    end: float | None = None,
    forces: bool = False,
    rotations: bool = False,
    schedule: Schedule | None = None,
    progress: Progress = None,
) -> Simulation:
    """A run from equilibrium at rest along commands.

    Until the start the motors hold the arm where its encoders show the first command; an integral part starts
    there.

    Parameters
    ----------
    arm : Arm
        The model, with a controller for every commanded joint.
    drive : Drive
        Joints whose side is "command" follow through their controllers, others as in `flexarm.simulate`.
    step : float
        Longest time step [s]; the step is the largest part of the shortest sample time that is no longer.
    alpha, end, forces, rotations, progress
        As in `flexarm.simulate`.
    schedule : dict of str to callable, optional
        Controller of a joint at a time [s], for gains that change in a run; joint, type, deflection and
        sample time stay.

    Returns
    -------
    Simulation
        With `joint_command` and, where the model has a motor, `motor_voltage`. `motor_torque` is the torque
        on the rotor, `work` and `damped` are without the motor's electrical losses.

    Raises
    ------
    InvalidParameter
        If a commanded joint has no controller, or sample times have no common grid.
    NotConverged
        With time, iteration and residual.

    Examples
    --------
    >>> command = Drive.from_samples([0, 1, 2], {"hinge": [0, 0.1, 0.1]}, side="command")  # doctest: +SKIP
    >>> run = simulate_closed_loop(arm, command)  # doctest: +SKIP
    """
    if not step > 0:
        raise InvalidParameter(f"step must be positive, got {step:g} s")
    controllers = _controllers(arm, drive)
    grid = SampleGrid.of(controllers, step)
    options = _core.TransientOptions()
    options.start, options.end = drive.start, drive.end if end is None else float(end)
    options.step, options.alpha = grid.step, float(alpha)
    options.record_energies, options.record_forces, options.record_rotations = True, forces, rotations

    losses = losses_of(arm, controllers)
    moved = with_losses(arm, losses)
    system = assemble(moved, {name: joint.kind for name, joint in drive.joints.items()})
    equilibrium, holding = _held(moved, drive, system, options.start)
    laws = schedule or {}
    loops = {
        name: Loop(arm, controller, drive.joints[name], holding[name], laws.get(name))
        for name, controller in controllers.items()
    }
    others = {name: joint for name, joint in drive.joints.items() if name not in controllers}
    began = perf_counter()
    run = _core.SampledRun(system, equilibrium, motions(arm, replace(drive, joints=others)), options)
    with reported(progress, arm.name) as report:
        voltage = _sampled(run, loops, grid, options, len(arm.joints), report)
    transient = run.result()
    found = simulation_of(arm, transient, options, Energies.of(transient))
    found.solver["seconds"] = perf_counter() - began
    return _commanded(without_losses(found, losses), loops, np.repeat(voltage, grid.substeps, axis=0))


def _sampled(
    run: _core.SampledRun,
    loops: Mapping[str, Loop],
    grid: SampleGrid,
    options: _core.TransientOptions,
    n_joints: int,
    report: Report,
) -> Floats:
    """Takes the run to its end; the voltages [V] of every tick and joint, NaN where there is none."""
    count = grid.count(options.start, options.end)
    times = grid.instants(options.start, count)
    commands = {name: loop.command(times) for name, loop in loops.items()}
    torque, voltage = np.zeros(n_joints), np.full((count, n_joints), np.nan)
    for k in range(count):
        for name, loop in loops.items():
            if k % grid.every[name] == 0:
                volts, torque[loop.joint] = loop.sample(run, float(commands[name][k]))
                voltage[k : k + grid.every[name], loop.joint] = volts
        run.advance(torque, grid.substeps)
        if report is not None and k % _LOOK == 0 and report(k / count) is False:
            break
    return voltage


def _held(
    arm: Arm, drive: Drive, system: _core.System, start: float
) -> tuple[_core.Equilibrium, dict[str, float]]:
    """Equilibrium in which the motors stand at the first command, and what each gives there [N m]."""
    held = assemble(
        arm,
        {
            name: _core.DriveKind.motor_angle if joint.side == "command" else joint.kind
            for name, joint in drive.joints.items()
        },
    )
    first = {name: float(joint(start)) for name, joint in drive.joints.items()}
    for name, controller in _controllers(arm, drive).items():
        first[name] = _shown_at(arm, controller, first[name])
    values = joint_values(arm, {**drive.rest, **first})
    equilibrium = _core.static_equilibrium(held, values, _core.Loads(gravity=np.array(arm.gravity)))
    torques = _core.motor_torques(held, equilibrium.state, False)
    named = {joint.name: float(torque) for joint, torque in zip(arm.joints, torques, strict=True)}
    return _core.released(held, equilibrium, system), named


def _shown_at(arm: Arm, controller: Controller, command: float) -> float:
    """Where the controller's encoder shows the command."""
    angle = Sensing(arm, controller).true_angle(command)
    if isnan(angle):
        raise InvalidParameter(
            f"the encoder of joint {controller.joint!r} never shows the command {command:g}: an effect on it "
            "hides the angle",
            where=f"controllers.{controller.joint}",
        )
    return angle


def _controllers(arm: Arm, drive: Drive) -> dict[str, Controller]:
    """The controllers of commanded joints."""
    known = {controller.joint: controller for controller in arm.controllers}
    found = {}
    for name, joint in drive.joints.items():
        if joint.side == "torque":
            raise InvalidParameter("a torque and a command in one run are not supported", where=name)
        if joint.side != "command":
            continue
        if name not in known:
            raise InvalidParameter(
                f"joint {name!r} is moved by a command, but has no controller; controllers exist for "
                f"{', '.join(known) or 'no joint'}",
                where="controllers",
            )
        found[name] = known[name]
    return found


def _commanded(run: Simulation, loops: Mapping[str, Loop], voltage: Floats) -> Simulation:
    """The run with what its loops were asked for, and their voltages [V] of every step."""
    command = np.full(run.drive_angle.shape, np.nan)
    for loop in loops.values():
        command[:, loop.joint] = loop.command(run.time + 1e-9)
    held = np.concatenate([voltage, voltage[-1:]])[: len(run.time)]
    return replace(run, joint_command=read_only(command), motor_voltage=read_only(held))
