"""Drives of a run: the motion of every driven joint, and where the others stand."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from flexarm.arguments import ARRAY, ARRAYS, takes
from flexarm.arm import Arm
from flexarm.arm.consistency import missing
from flexarm.arrays import Floats
from flexarm.drive.joint_drive import JointDrive
from flexarm.errors import InvalidFile, InvalidParameter
from flexarm.measurement.smoothing import interpolate
from flexarm.record import Record
from flexarm.record.columns import CsvFile
from flexarm.tables.ranges import first_beyond, out_of_range, range_of
from flexarm.wording import stamp

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, repr=False)
class Drive:
    """Drives of a run.

    Attributes
    ----------
    joints : dict of str to JointDrive
        Driven joints; the others stand still.
    rest : dict of str to float
        Where joints stand that nothing drives [rad or m]; default 0.
    start, end : float
        Time that the run shall cover [s].
    rates : dict of str to float, optional
        The run begins in motion: joints that a torque drives with these rates [rad/s or m/s], 0 by default,
        the others with those of their drives. None: it begins at rest.
    lead : float
        How long before `start` a run begins, at rest [s] (`flexarm.drive.lead_in`); no part of its result.
    """

    joints: Mapping[str, JointDrive]
    rest: Mapping[str, float] = field(default_factory=dict)
    start: float = 0.0
    end: float = 0.0
    lead: float = 0.0
    rates: Mapping[str, float] | None = None

    def __repr__(self) -> str:
        joints = ", ".join(f"{name} ({joint.side})" for name, joint in self.joints.items())
        return f"<Drive of {joints or 'no joint'}: {stamp(self.start)} to {stamp(self.end)} s>"

    def sha256(self) -> str:
        """Return the hash of all that a run takes from the drive, for its provenance."""
        found = hashlib.sha256(repr((sorted(self.rest.items()), self.start, self.end)).encode())
        if self.rates is not None:
            found.update(repr(sorted(self.rates.items())).encode())
        for name, joint in sorted(self.joints.items()):
            found.update(f"{name} {joint.side}".encode() + joint.digest)
        return found.hexdigest()

    @classmethod
    @takes(time=ARRAY, values=ARRAYS)
    def from_samples(cls, time: ArrayLike, values: Mapping[str, ArrayLike], side: str = "motor") -> Drive:
        """Join exact samples by a cubic spline (not-a-knot), held before and after.

        Parameters
        ----------
        time : array_like, shape (n,)
            Times [s], rising.
        values : dict of str to array_like, shape (n,)
            Angle of each driven joint, output side [rad, m for a prismatic joint].
        side : {"motor", "output", "torque", "command"}
            See `JointDrive`. Commands are held from sample to sample, as a controller gets them.

        Raises
        ------
        InvalidParameter
            If times do not rise or a value is not finite.
        """
        t = np.asarray(time, dtype=float)
        least, most = range_of("s")
        if t.ndim != 1 or len(t) < 2 or not np.all(np.abs(t) <= most) or not np.all(np.diff(t) >= least):
            raise InvalidParameter("must be at least two finite, rising times [s]", where="time")
        joints = {}
        for name, samples in values.items():
            y = np.asarray(samples, dtype=float)
            if y.shape != t.shape:
                what = f"needs {len(t)} values, one for each time, got shape {y.shape}"
                raise InvalidParameter(what, where=name)
            if not np.all(np.isfinite(y)):
                row = int(np.argmin(np.isfinite(y)))
                raise InvalidParameter(f"must be finite, got {y[row]} at {t[row]:.9g} s", where=name)
            if at := first_beyond(y, "rad"):
                raise InvalidParameter(str(out_of_range(float(y[at]), "rad", size=False)), where=name)
            joints[name] = (
                JointDrive.held(t, y) if side == "command" else JointDrive(*interpolate(t, y), side)
            )
        return cls(joints, start=float(t[0]), end=float(t[-1]))

    @classmethod
    @takes()
    def from_csv(cls, path: str | Path, arm: Arm) -> Drive:
        """Read a CSV file with `time_s` and one column per driven joint, named after it.

        Raises
        ------
        InvalidFile
            With line and column of what is wrong.
        """
        return cls.from_samples(*samples_in(path, arm))

    @classmethod
    @takes()
    def from_record(cls, record: Record, arm: Arm) -> Drive:
        """Return the drive signals of a record: angles smoothed by their stated noise, commands held.

        Effects of the model on their sensors and clocks are taken back, outliers left out. The run covers
        every stamp of the record's known clocks. Joints that nothing drives stand where the
        record says.

        Parameters
        ----------
        record : Record
            A motion with joint angles or commands as drive.
        arm : Arm
            The model, with its effects.

        Raises
        ------
        InvalidParameter
            If the record holds poses, a drive is neither angle nor command of a joint, two drive the same
            joint, or an effect on a drive cannot act there or leaves nothing of it.
        """
        from flexarm.drive.from_record import attributes_in

        return cls(**attributes_in(record, arm))

    @takes()
    def at_inputs(self, arm: Arm) -> Drive:
        """Return the same motion with angles at outputs of gears moved to their inputs, where motors are."""
        joints = dict(self.joints)
        for _ in arm.gears:  # as often as there are gears, for trains of them
            for gear in arm.gears:
                moved = joints.get(gear.output)
                if moved is not None and moved.side == "motor" and gear.input not in joints:
                    del joints[gear.output]
                    joints[gear.input] = replace(moved, coefficients=gear.ratio * moved.coefficients)
        return replace(self, joints=joints)

    @takes()
    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw what drives each joint against time.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw; angles and torques share it.
        """
        import matplotlib.pyplot as plt

        axes = plt.subplots()[1] if ax is None else ax
        time = np.linspace(self.start, self.end, 2001)
        words = dict.fromkeys(("motor", "output"), "angle [rad, m if prismatic]")
        words |= {"torque": "torque [N m, N if prismatic]", "command": "command, as the controller takes it"}
        for name, joint in self.joints.items():
            axes.plot(time, joint(time), label=f"{name} ({joint.side})")
        kinds = dict.fromkeys(words[joint.side] for joint in self.joints.values())
        axes.set(xlabel="time [s]", ylabel=", ".join(kinds))
        if self.joints:
            axes.legend()
        return axes


def samples_in(path: str | Path, arm: Arm, idle: bool = False) -> tuple[Floats, dict[str, Floats]]:
    """Return times [s] and samples by joint; where all joints may be `idle`, times alone will do.

    Raise InvalidFile with line and column of what is wrong.
    """
    table = CsvFile(Path(path), path)
    if "time_s" not in table.header:
        raise InvalidFile(path, "header", missing("column", "time_s", table.header))
    moving = [joint.name for joint in arm.moving_joints]
    names = [name for name in table.header if name != "time_s"]
    for name in names:
        if name not in moving:
            what = f"is no moving joint of the model; there are {', '.join(moving)}"
            raise InvalidFile(path, f"column {name}", what)
    if not names and not idle:
        raise InvalidFile(path, "header", f"drives no joint; add a column named {' or '.join(moving)}")
    rows = table.numbers(["time_s", *names])
    if len(rows) < 2:
        raise InvalidFile(path, "file", f"needs at least two rows of numbers, got {len(rows)}")
    wrong = np.argwhere(~np.isfinite(rows))
    if len(wrong):
        row, column = wrong[0]
        where = f"line {table.line(int(row))}, column {['time_s', *names][column]}"
        raise InvalidFile(path, where, "must be a finite number; a drive has no drop-outs")
    units = ["s", *("m" if arm.joint(name).type == "prismatic" else "rad" for name in names)]
    for name, column, unit in zip(["time_s", *names], rows.T, units, strict=True):
        if at := first_beyond(column, unit):
            what = str(out_of_range(float(column[at]), unit, size=False))
            raise InvalidFile(path, f"line {table.line(at[0])}, column {name}", what)
    time = rows[:, 0]
    backward = np.flatnonzero(np.diff(time) < range_of("s")[0])
    if len(backward):
        k = int(backward[0]) + 1
        where = f"line {table.line(k)}, column time_s"
        raise InvalidFile(
            path, where, f"times must rise, got {stamp(time[k])} s after {stamp(time[k - 1])} s"
        )
    return time, {name: rows[:, i] for i, name in enumerate(names, 1)}
