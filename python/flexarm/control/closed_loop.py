"""Transient of an arm under sampled controllers.

At every sample a controller reads its sensors and sets a torque, which is held until the next one while the
finite elements go on in equal steps. Samples of all controllers fall on a common grid.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import ceil, isclose, isnan
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.controller import Cascade, Controller
from flexarm.assembly import assemble, joint_values
from flexarm.control.actuator import TorqueDrive, VoltageDrive
from flexarm.control.laws import CascadeLaw, feedback_voltage
from flexarm.control.sensing import Sensing
from flexarm.drive import Drive, JointDrive
from flexarm.effects import MotorFriction
from flexarm.errors import InvalidParameter
from flexarm.simulation import Progress, Simulation, reported
from flexarm.simulation.energies import Energies
from flexarm.simulation.from_core import simulation_of

Floats = NDArray[np.float64]
Schedule = Mapping[str, Callable[[float], Controller]]
_LOOK = 64
"""Samples between two reports of progress."""


class _Loop:
    """Sensors, law and motor of one joint."""

    def __init__(self, arm: Arm, controller: Controller, command: JointDrive, holding: float) -> None:
        joint = arm.joint(controller.joint)
        motor = next((motor for motor in arm.motors if motor.joint == joint.name), None)
        self.joint = [entry.name for entry in arm.joints].index(joint.name)
        self.command = command
        self._controller = controller
        self._sensing = Sensing(arm, controller)
        self._law = CascadeLaw(holding)
        if isinstance(controller, Cascade) or motor is None:
            self.actuator: TorqueDrive | VoltageDrive = TorqueDrive(controller, motor, joint)
        else:
            self.actuator = VoltageDrive(motor, joint)

    def sample(self, run: _core.SampledRun, command: float, controller: Controller) -> tuple[float, float]:
        """Voltage [V] and torque to hold [N m] of this sample."""
        reading = self._sensing.read(run)
        if not isinstance(controller, Cascade):
            return self.actuator.hold(feedback_voltage(controller, command, reading), reading.rate)
        wanted = self._law.torque(controller, command, reading)
        voltage, torque = self.actuator.hold(wanted, reading.rate)
        self._law.settle(limited=torque != wanted)
        return voltage, torque


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
    tick = min(controller.sample_time for controller in controllers.values())
    every = {name: _multiple(controller, tick) for name, controller in controllers.items()}
    options = _core.TransientOptions()
    options.start, options.end = drive.start, drive.end if end is None else float(end)
    substeps = max(1, ceil(tick / step - 1e-9))
    options.step, options.alpha = tick / substeps, float(alpha)
    options.record_energies, options.record_forces, options.record_rotations = True, forces, rotations

    losses = {name: _back_emf(arm, controller) for name, controller in controllers.items()}
    moved = _with_back_emf(arm, losses)
    system = assemble(moved, {name: joint.kind for name, joint in drive.joints.items()})
    equilibrium, holding = _held(moved, drive, system, options.start)
    still = _core.PiecewisePolynomial.constant(0.0)
    drives = [
        drive.joints[joint.name].polynomial()
        if joint.name in drive.joints and joint.name not in controllers
        else still
        for joint in arm.joints
    ]
    names = [joint.name for joint in arm.joints]
    loops = {
        name: _Loop(arm, controller, drive.joints[name], holding[names.index(name)])
        for name, controller in controllers.items()
    }
    began = perf_counter()
    run = _core.SampledRun(system, equilibrium, drives, options)
    n_ticks = ceil((options.end - options.start) / tick - 1e-9)
    # A command that changes at a sample counts from that sample on, whatever the last bit of the time.
    times = options.start + tick * (np.arange(n_ticks + 1) + 1e-6)
    commands = {name: loop.command(times) for name, loop in loops.items()}
    torque, voltage = np.zeros(len(names)), np.full((n_ticks, len(names)), np.nan)
    with reported(progress, arm.name) as report:
        for k in range(n_ticks):
            for name, loop in loops.items():
                if k % every[name] == 0:
                    law = schedule[name](run.time) if schedule and name in schedule else controllers[name]
                    volts, torque[loop.joint] = loop.sample(run, float(commands[name][k]), law)
                    voltage[k : k + every[name], loop.joint] = volts
            run.advance(torque, substeps)
            if report is not None and k % _LOOK == 0 and report(k / n_ticks) is False:
                break
    transient = run.result()
    found = simulation_of(arm, transient, options, Energies.of(transient))
    seconds = perf_counter() - began
    return _completed(found, drive, loops, losses, np.repeat(voltage, substeps, axis=0), seconds)


def _held(arm: Arm, drive: Drive, system: _core.System, start: float) -> tuple[_core.Equilibrium, Floats]:
    """Equilibrium in which the motors stand at the first command, and what they give there [N m]."""
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
    torques = np.asarray(_core.motor_torques(held, equilibrium.state, False))
    return _core.released(held, equilibrium, system), torques


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


def _multiple(controller: Controller, tick: float) -> int:
    ratio = controller.sample_time / tick
    if not isclose(ratio, round(ratio), rel_tol=1e-9):
        raise InvalidParameter(
            f"must be a multiple of the shortest sample time, {tick:g} s, got {controller.sample_time:g} s",
            where=f"controllers.{controller.joint}.sample_time",
        )
    return round(ratio)


def _back_emf(arm: Arm, controller: Controller) -> float:
    """c of `actuator`, eq. (1) [N m s/rad]; zero where a current loop sets the torque."""
    motor = next((motor for motor in arm.motors if motor.joint == controller.joint), None)
    if isinstance(controller, Cascade) or motor is None:
        return 0.0
    return VoltageDrive(motor, arm.joint(controller.joint)).back_emf


def _with_back_emf(arm: Arm, losses: Mapping[str, float]) -> Arm:
    """The arm with the back-EMF as viscous friction of its motors."""
    for name, coefficient in losses.items():
        if coefficient == 0:
            continue
        own = next((e for e in arm.effects_at(name) if isinstance(e, MotorFriction)), MotorFriction(at=name))
        arm = arm.with_effect(own.replace(viscous=own.viscous + coefficient))
    return arm


def _completed(
    run: Simulation,
    drive: Drive,
    loops: Mapping[str, _Loop],
    losses: Mapping[str, float],
    voltage: Floats,
    seconds: float,
) -> Simulation:
    """Adds command and voltage, and takes the back-EMF out of torques and energies."""
    n, n_joints = run.drive_angle.shape
    command = np.full((n, n_joints), np.nan)
    torque, lost = run.motor_torque.copy(), np.zeros(n)
    for name, loop in loops.items():
        j, rate = loop.joint, run.drive_rate[:, loop.joint]
        command[:, j] = drive.joints[name](run.time + 1e-9)
        torque[:, j] -= losses[name] * rate
        power = 0.5 * losses[name] * np.diff(run.drive_angle[:, j]) * (rate[1:] + rate[:-1])
        lost[1:] += np.cumsum(power)
    held = np.full((n, n_joints), np.nan)
    held[:] = np.concatenate([voltage, voltage[-1:]])[:n]
    return replace(
        run,
        joint_command=_frozen(command),
        motor_voltage=_frozen(held),
        motor_torque=_frozen(torque),
        energy_record=replace(run.energies, damped=_frozen(run.damped - lost), work=_frozen(run.work - lost)),
        solver={**run.solver, "seconds": seconds},
    )


def _frozen(values: Floats) -> Floats:
    values.setflags(write=False)
    return values
