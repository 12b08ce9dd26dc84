"""An experiment that has not been run: motion, sensors, what is carried, and how clocks and frames are known.

Its virtual record is what the sensors would write of a model.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm.sensor import Sensor
from flexarm.drive import Drive
from flexarm.measurement.measure import measure
from flexarm.record import Clock, Frame, Record, Signal
from flexarm.simulation import Simulation, simulate

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.record.table import CarriedPayload, DrawnLink

DRIVE_HZ = 250.0
"""Samples of the drive a second."""


@dataclass(frozen=True, eq=False)
class Experiment:
    """A run that may be made.

    Attributes
    ----------
    name : str
        For people.
    drive : Drive
        The motion.
    drivers : dict of str to str
        Joints that move and the signals that show it.
    sensors : tuple of Sensor
        What is measured beside the drive.
    clocks : dict of str to Clock
        The first is that of the drive.
    frames : dict of str to Frame
        Of trackers.
    payloads, links
        What the run carries and how far links are drawn out, as in a record.
    assumed : tuple of str
        Sentences about what nobody stated.
    """

    name: str
    drive: Drive
    drivers: Mapping[str, str]
    sensors: tuple[Sensor, ...]
    clocks: Mapping[str, Clock]
    frames: Mapping[str, Frame]
    payloads: Mapping[str, CarriedPayload] = field(default_factory=dict)
    links: Mapping[str, DrawnLink] = field(default_factory=dict)
    assumed: tuple[str, ...] = ()

    def run(self, arm: Arm, step: float, alpha: float) -> Simulation:
        """The motion of a model."""
        tables = Record(signals={}, payloads=self.payloads, links=self.links)
        forces = any(sensor.quantity == "strain" for sensor in self.sensors)
        return simulate(
            tables.applied_to(arm), self.drive, step=step, alpha=alpha, rotations=True, forces=forces
        )

    def record(self, arm: Arm, step: float, alpha: float) -> Record:
        """What the sensors would write of a model; with their noise, which no difference of models sees."""
        run = self.run(arm, step, alpha)
        seen = measure(
            run,
            self.sensors,
            np.random.default_rng(0),
            clocks=self.clocks,
            frames=self.frames,
            payloads=self.payloads,
            links=self.links,
            joints=dict(self.drive.rest),
        )
        drives = [self._shown(joint, name, arm) for joint, name in self.drivers.items()]
        signals = {**{signal.name: signal for signal in drives}, **seen.signals}
        initial = "moving" if self.drive.lead else "equilibrium"
        drivers = tuple(self.drivers.values())
        return seen.replace(signals=signals, drive=drivers, initial=initial, description=self.name)

    def _shown(self, joint: str, name: str, arm: Arm) -> Signal:
        """The signal of a drive, exact."""
        moved = self.drive.joints[joint]
        count = max(round((self.drive.end - self.drive.start) * DRIVE_HZ), 8)
        time = np.linspace(self.drive.start, self.drive.end, count + 1)
        command = moved.side == "command"
        return Signal(
            name=name,
            quantity="joint_command" if command else "joint_angle",
            values=moved(time),
            time=time,
            unit="m" if arm.joint(joint).type == "prismatic" else "rad",
            noise_std=0.0,
            clock=next(iter(self.clocks)),
            joint=joint,
            side=None if command else "output" if moved.side == "output" else "motor",
        )

    # ------------------------------------------------------------------ variants

    def faster(self, times: float) -> Experiment:
        """The same path in another time."""
        drive = self.drive
        joints = {
            name: replace(
                each,
                breaks=drive.start + (each.breaks - drive.start) / times,
                coefficients=each.coefficients * times ** np.arange(len(each.coefficients))[::-1, None],
            )
            for name, each in drive.joints.items()
        }
        end = drive.start + (drive.end - drive.start) / times
        return replace(self, drive=replace(drive, joints=joints, end=end, lead=drive.lead / times))

    def turned(self, joint: str, angle: float) -> Experiment:
        """The same motion with a joint elsewhere [rad, m]."""
        drive = self.drive
        if joint not in drive.joints:
            rest = {**drive.rest, joint: drive.rest.get(joint, 0.0) + angle}
            return replace(self, drive=replace(drive, rest=rest))
        moved = drive.joints[joint]
        coefficients = moved.coefficients.copy()
        coefficients[-1] += angle
        joints = {**drive.joints, joint: replace(moved, coefficients=coefficients)}
        return replace(self, drive=replace(drive, joints=joints))
