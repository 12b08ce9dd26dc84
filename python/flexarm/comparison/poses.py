"""Static records: every pose is an equilibrium, and all together read like a simulation.

The number of the pose takes the place of time. Inputs of a pose are its joint angles (drive signals, of motor
or link as their side says; other joints stand where the record says), forces at points and payload masses.
Rows of one pose are repeated measurements: inputs are their means, outputs are compared row by row. Effects
of the model on sensors of inputs are taken back first.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.parameter import Parameter, neighbours, parameters
from flexarm.arm.sensor_effect import SignalEffect
from flexarm.arrays import Floats
from flexarm.assembly import joint_values
from flexarm.comparison.pose_sequence import SEEN, PoseSequence, sequence, slopes_of
from flexarm.comparison.simulated_record import SimulatedRecord, pair_record
from flexarm.errors import InvalidParameter
from flexarm.measurement.effects_of import effects_of
from flexarm.measurement.sampling import columns
from flexarm.record import Record, Signal
from flexarm.record.compatibility import with_payload_masses
from flexarm.record.plausibility import INPUTS
from flexarm.sensitivity import Sensitivities, entry_of
from flexarm.statics.batch import DriveVariation, StaticsBatch, StaticSolution

FORCES = ("motor_torque", "motor_voltage", "force", "strain")
"""Quantities that see torques and forces."""
NEEDED = {"position": ("position",), "acceleration": ("rotation",), "joint_angle": ("link_angle",)}
"""Arrays of an equilibrium that a quantity is read from; of others it may be any."""


def is_input(record: Record, signal: Signal) -> bool:
    """Return True if a signal of a static record is an input, not a response."""
    return signal.name in record.drive or signal.quantity in INPUTS


def solve_poses(arm: Arm, record: Record, *, sensitivities: Iterable[str] = ()) -> PoseSequence:
    """Solve the equilibrium of every pose of a static record, with derivatives as in `simulate`.

    Raise InvalidParameter if a drive does not say where a joint stands in a pose, or there is no derivative
    by a parameter, and NotConverged if a pose has no stable equilibrium.
    """
    model = _StaticModel(arm, record, parameters(arm, sensitivities))
    found = [model.held(model.inputs(pose), model.turning(pose)) for pose in record.poses]
    run = sequence(arm, found)
    return replace(run, sensitivities=_sensitivities(model, run, found)) if model.wanted else run


@dataclass(frozen=True)
class _PoseInputs:
    """Hold the inputs of one pose: angles [rad, m], forces [N] and weighed payloads [kg]."""

    angles: Mapping[str, float]
    forces: Mapping[str, Floats]
    masses: Mapping[str, float]


class _StaticModel:
    """Assemble the arm of a static record once for every set of payloads that its poses carry."""

    def __init__(self, arm: Arm, record: Record, wanted: tuple[Parameter, ...]) -> None:
        self.arm, self.record, self.wanted = arm, record, wanted
        signals = record.signals.values()
        drives = [record.signals[name] for name in record.drive]
        self.at_link = {signal.joint for signal in drives if signal.side == "output" and signal.joint}
        self.turned = {signal.joint for signal in drives if signal.joint} - self.at_link
        self.loaded = {s.point for s in signals if s.quantity == "force" and s.point is not None}
        self.true = self.readings(arm)
        read = (s for s in signals if not is_input(record, s))
        needed = {name for signal in read for name in NEEDED.get(signal.quantity, SEEN)}
        self.differentiated = tuple(name for name in SEEN if name in needed)
        self._arms: dict[tuple[tuple[str, float], ...], StaticsBatch] = {}
        self._turning = {
            parameter.key: [(self.readings(other), change) for other, change in neighbours(arm, parameter)]
            for parameter in wanted
            if self.quantity_read_by(parameter) == "joint_angle"
        }

    def readings(self, arm: Arm) -> dict[str, Floats]:
        """Return true values of the inputs, with an arm's effects on their sensors taken back."""
        return {
            name: effects_of(arm, signal).true(signal.values)
            for name, signal in self.record.signals.items()
            if is_input(self.record, signal)
        }

    def inputs(self, pose: str, true: Mapping[str, Floats] | None = None) -> _PoseInputs:
        """Return the inputs of a pose from the true values of its signals."""
        true = self.true if true is None else true
        angles: dict[str, float] = {}
        forces: dict[str, Floats] = {}
        masses: dict[str, float] = {}
        for signal in self.record.signals.values():
            if signal.pose is None or not is_input(self.record, signal):
                continue
            values = true[signal.name]
            rows = values[(signal.pose == pose) & np.isfinite(values).all(axis=1)]
            if not len(rows):
                if signal.name in self.record.drive:
                    raise InvalidParameter(
                        f"holds no value for the pose {pose!r}; "
                        "a drive needs one for every pose of the record",
                        where=f"signals.{signal.name}",
                    )
                continue
            mean = rows.mean(axis=0)
            if signal.quantity == "force" and signal.point is not None:
                forces.setdefault(signal.point, np.zeros(3))[columns(signal.axes)] += mean
            elif signal.quantity == "payload_mass" and signal.payload is not None:
                masses[signal.payload] = float(mean[0])
            elif signal.joint is not None:
                angles[signal.joint] = float(mean[0])
        return _PoseInputs(angles, forces, masses)

    def quantity_read_by(self, parameter: Parameter) -> str | None:
        """Return the quantity of the input sensor to which a parameter belongs, else None."""
        entry = entry_of(self.arm, parameter)
        if not isinstance(entry, SignalEffect) or entry.at not in self.true:
            return None
        return self.record.signals[entry.at].quantity

    def turning(self, pose: str) -> dict[str, DriveVariation]:
        """Return the angles of a pose at perturbed parameters of the encoders."""
        found = {}
        for key, sides in self._turning.items():
            (above, up), (below, down) = (
                (joint_values(self.arm, {**self.record.joints, **self.inputs(pose, true).angles}), change)
                for true, change in sides
            )
            found[key] = DriveVariation(above, up, below, down)
        return found

    def held(
        self, inputs: _PoseInputs, turning: Mapping[str, DriveVariation] | None = None
    ) -> StaticSolution:
        """Solve the equilibrium of one pose."""
        load = tuple(sorted(inputs.masses.items()))
        if load not in self._arms:
            carried = with_payload_masses(self.arm, inputs.masses)
            keys = [parameter.key for parameter in self.wanted]
            self._arms[load] = StaticsBatch(
                carried, self.at_link, self.loaded, keys, self.turned, self.differentiated
            )
        return self._arms[load].at({**self.record.joints, **inputs.angles}, inputs.forces, turning)


def _sensitivities(model: _StaticModel, run: PoseSequence, found: list[StaticSolution]) -> Sensitivities:
    """Return derivatives of a sequence, also with respect to parameters of force sensors."""
    slopes = {
        name: np.stack([held.sensitivities[name] for held in found if held.sensitivities])
        for name in (*model.differentiated, "drive_angle")
    }
    for k, parameter in enumerate(model.wanted):
        if model.quantity_read_by(parameter) == "force":
            for name, array in _force_derivatives(model, parameter).items():
                slopes[name][..., k] = array
    return Sensitivities(model.wanted, slopes_of(model.arm, run, slopes))


def _force_derivatives(model: _StaticModel, parameter: Parameter) -> dict[str, Floats]:
    """Return derivatives with respect to a force sensor, from two more equilibria a pose."""
    (above, up), (below, down) = neighbours(model.arm, parameter)
    bare = _StaticModel(model.arm, model.record, ())
    sides = []
    for other in (above, below):
        true = model.readings(other)
        sides.append([bare.held(bare.inputs(pose, true)) for pose in model.record.poses])
    return {
        name: np.array([a.arrays[name] - b.arrays[name] for a, b in zip(*sides, strict=True)]) / (up - down)
        for name in model.differentiated
    }


def with_turned(record: Record, joint: str, angles: Floats) -> Record:
    """Return a record whose poses turn the motor of a joint further, by `angles` of shape (poses,) [rad]."""
    drives = [record.signals[name] for name in record.drive if record.signals[name].joint == joint]
    if not drives:  # a joint at rest
        name = joint
        while name in record.signals:
            name += "_"
        values = record.joints.get(joint, 0.0) + angles
        stands = Signal(
            name=name, quantity="joint_angle", joint=joint, pose=np.array(record.poses), values=values
        )
        return record.replace(signals={**record.signals, name: stands}, drive=(*record.drive, name))
    number = pose_numbers(record)
    turned = {
        each.name: each.replace(values=each.values + angles[number[each.name].astype(int), None])
        for each in drives
    }
    return record.replace(signals={**record.signals, **turned})


def pair_poses(run: PoseSequence, record: Record, arm: Arm) -> SimulatedRecord:
    """Pair a static record with the equilibria of its poses; inputs of the poses are not compared."""
    inputs = {name: "is an input of the poses" for name, s in record.signals.items() if is_input(record, s)}
    return pair_record(run, record, pose_numbers(record), inputs, arm)


def pose_numbers(record: Record) -> dict[str, Floats]:
    """Return the number of the pose of every row, by signal."""
    number = {pose: float(i) for i, pose in enumerate(record.poses)}
    return {
        name: np.array([number[str(pose)] for pose in signal.pose])
        if signal.pose is not None
        else signal.time
        for name, signal in record.signals.items()
    }
