r"""Derivatives of runs under controllers by parameters p of the model.

Between two samples the core differentiates the arm's motion under held torques. At a sample every reading y
comes with its derivative, and the same law that gives the torque gives (`flexarm.control.dual`)

    dT/dp = ∂T/∂y dy/dp + ∂T/∂x dx/dp + ∂T/∂p                                                        (1)

with the law's memories x: the integral part and the last readings, whose derivatives go from sample to
sample. The last term is that of motors and of effects on sensors in the loop; it is a difference of models
with a little more of the parameter and a little less. The integral part begins at the torque that holds the
arm, whose derivative is that of statics.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.parameter import Parameter, neighbours
from flexarm.arm.sensor_effect import ClockEffect, SignalEffect
from flexarm.arrays import Floats
from flexarm.control.actuator import actuator_of, differentiated
from flexarm.control.controlled import ControlledArm
from flexarm.control.dual import Dual, Real
from flexarm.control.loop import ControlLoop
from flexarm.control.plant import DifferentiatedPlant
from flexarm.control.sensing import DifferentiatedSensing, Sensing
from flexarm.drive import Drive
from flexarm.errors import InvalidParameter
from flexarm.record import Record
from flexarm.sensitivity import Redrive, Sensitivities, collected, entry_of, varied
from flexarm.simulation.simulation import Simulation
from flexarm.simulation.solve import derived
from flexarm.statics.backlash_derivative import require_backlash_derivative


class Differentiation:
    """The parameters and the derivatives of a run under controllers that begins at `start` [s].

    Effects on what a record showed move the drive that comes from it. Raise InvalidParameter if there is no
    derivative by one of the parameters.
    """

    def __init__(
        self, task: ControlledArm, wanted: tuple[Parameter, ...], start: float, record: Record | None
    ) -> None:
        self._task, self._wanted, self._record = task, wanted, record
        for parameter in wanted:
            self._refuse_late_commands(parameter)
        sensors = {name for each in task.controllers.values() for name in Sensing(task.arm, each).sensors}
        places = sensors | _places_of(record, ("joint_angle", "joint_command"))
        self._moving, self._places = varied(
            task.arm,
            wanted,
            lambda other: replace(task, arm=other).system,
            Redrive(places, lambda other: self._redriven(other).motions, task.drive.joints),
            driven={*task.drive.joints, *task.drive.rest},
        )
        self._still, _ = varied(
            task.arm,
            wanted,
            lambda other: replace(task, arm=other).held,
            Redrive(places, lambda other: self._redriven(other).first_motions(start), task.drive.joints),
            driven={*task.drive.joints, *task.drive.rest},
        )
        acting = [wanted[place] for place in self._places]
        self._arms: list[tuple[Arm, Arm]] = []
        self._spreads: list[float] = []
        for parameter in acting:
            (plus, up), (minus, down) = neighbours(task.arm, parameter)
            self._arms.append((plus, minus))
            self._spreads.append(up - down)
        self._equilibrium = task.at_rest(start)
        self._initial = _core.static_derivative(task.held, self._equilibrium, self._still, start)
        require_backlash_derivative(
            task.arm,
            acting,
            self._still,
            task.held,
            self._equilibrium,
            self._initial,
            lambda other: task.at_rest(start, other),
        )

    def plant(self, options: _core.TransientOptions) -> DifferentiatedPlant:
        """Return the arm with the derivatives of all that it shows, at its start."""
        task = self._task
        run = _core.DifferentiatedSampledRun(
            task.system,
            _core.released(task.held, self._equilibrium, task.system),
            task.motions,
            options,
            self._moving,
            _core.released_derivative(task.held, self._initial, task.system),
        )
        return DifferentiatedPlant(run, len(self._arms))

    def loops(self) -> dict[str, ControlLoop]:
        """Return the loops of commanded joints, with derivatives of sensors, motors and holding torques."""
        arm, found = self._task.arm, {}
        torques = _core.motor_torques(self._task.held, self._equilibrium.state, False)
        slopes = self._holding_slopes()
        for name, controller in self._task.controllers.items():
            sensing = DifferentiatedSensing(arm, controller, self._arms, self._spreads)
            motors = [tuple(actuator_of(other, controller) for other in pair) for pair in self._arms]
            found[name] = ControlLoop(
                lambda time, controller=controller: controller,  # type: ignore[misc]
                sensing,
                differentiated(actuator_of(arm, controller), motors, self._spreads),  # type: ignore[arg-type]
                Dual(float(torques[sensing.joint]), slopes[:, sensing.joint]),
            )
        return found

    def commands(self, name: str, times: Floats) -> Sequence[Real]:
        """Return the commands of a joint at times [s]."""
        values, slopes = self._task.drive.joints[name](times), self._command_slopes(name, times)
        return [Dual(float(value), slope) for value, slope in zip(values, slopes, strict=True)]

    def collected(
        self, run: Simulation, derivatives: _core.Transient, voltage_slopes: Floats
    ) -> Sensitivities:
        """Return the derivatives of a run's arrays, which has torques of the motors, voltages and commands.

        `derivatives` are the core's columns, `voltage_slopes` have the shape (instant, joint, parameter).
        """
        arrays = derived(run, derivatives, len(self._places))
        arrays["motor_torque"] = arrays["motor_torque"].copy()
        assert run.joint_command is not None
        command_slopes = np.full((*run.joint_command.shape, len(self._places)), np.nan)
        for name in self._task.controllers:
            j = run.joints.index(name)
            arrays["motor_torque"][:, j] -= self._loss_slopes(name, run, arrays["drive_rate"][:, j])
            command_slopes[:, j] = self._command_slopes(name, commanded_at(run.time))
        arrays |= {"joint_command": command_slopes, "motor_voltage": voltage_slopes}
        return collected(self._wanted, self._places, arrays)

    def _loss_slopes(self, name: str, run: Simulation, rate_slopes: Floats) -> Floats:
        """Return d(c φ')/dp of the back-EMF c φ', (instant, parameter)."""
        losses = [tuple(replace(self._task, arm=arm).losses[name] for arm in pair) for pair in self._arms]
        slopes = [
            (plus - minus) / spread for (plus, minus), spread in zip(losses, self._spreads, strict=True)
        ]
        rate = run.drive_rate[:, run.joints.index(name), None]
        found: Floats = self._task.losses[name] * rate_slopes + rate * np.array(slopes)
        return found

    def _command_slopes(self, name: str, times: Floats) -> Floats:
        """Return the derivatives of a joint's commands, (instant, parameter)."""
        slopes = np.zeros((len(times), len(self._arms)))
        told = _places_of(self._record, ("joint_command",))
        for k, (pair, place) in enumerate(zip(self._arms, self._places, strict=True)):
            entry = entry_of(self._task.arm, self._wanted[place])
            if isinstance(entry, SignalEffect) and entry.at in told:
                plus, minus = (self._redriven(arm).drive.joints[name](times) for arm in pair)
                slopes[:, k] = (plus - minus) / self._spreads[k]
        return slopes

    def _redriven(self, arm: Arm) -> ControlledArm:
        """Return another arm along the same record."""
        drive = self._task.drive if self._record is None else Drive.from_record(self._record, arm)
        return replace(self._task, arm=arm, drive=drive)

    def _refuse_late_commands(self, parameter: Parameter) -> None:
        entry = entry_of(self._task.arm, parameter)
        if isinstance(entry, ClockEffect) and entry.at in _places_of(self._record, ("joint_command",)):
            raise InvalidParameter(
                f"{parameter.key} has no derivative in a run under a controller: a command that is held from "
                "sample to sample and read a little later is the same one, or jumps to the next",
                where="sensitivities",
            )

    def _holding_slopes(self) -> Floats:
        """Return the derivatives of the torques that hold the arm, (parameter, joint)."""
        state, found = self._equilibrium.state, []
        for k, pair in enumerate(self._still):
            high, low = (
                np.asarray(
                    _core.motor_torques(
                        model, _core.moved(self._task.held, state, self._initial, k, change), False
                    )
                )
                for model, change in ((pair.plus, pair.up), (pair.minus, pair.down))
            )
            found.append((high - low) / (pair.up - pair.down))
        return np.array(found).reshape(len(self._still), len(self._task.arm.joints))


def commanded_at(time: Floats) -> Floats:
    """Return instants at which commands are read [s]: one that changes at an instant counts from it on."""
    return time + 1e-9


def _places_of(record: Record | None, quantities: Sequence[str]) -> set[str]:
    """Return the driving signals of these quantities, and their clocks."""
    if record is None:
        return set()
    signals = [record.signals[name] for name in record.drive]
    found = {signal.name for signal in signals if signal.quantity in quantities}
    return found | {signal.clock for signal in signals if signal.quantity in quantities}
