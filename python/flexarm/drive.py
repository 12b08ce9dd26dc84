"""What moves the joints: piecewise polynomials in time, one a driven joint.

A record's drive is what an encoder showed and when its clock said so. Where the model has effects on them
(`flexarm.measurement.effects_of`), the arm is driven by what was true: readings are turned into true angles
and stamps into true time before the samples are smoothed. How much they are smoothed follows from the
readings and their noise, so that the drive depends smoothly on the parameters of these effects.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexarm import _core
from flexarm.errors import InvalidFile, InvalidParameter
from flexarm.measurement.clocks import ClockError
from flexarm.measurement.effects_of import effects_of
from flexarm.measurement.outliers import drive_outliers
from flexarm.measurement.smoothing import interpolate, smooth
from flexarm.record.columns import CsvFile

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.record import Record, Signal

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class JointDrive:
    """Motion of one joint as scipy.interpolate.PPoly has it, held before and after.

    Attributes
    ----------
    breaks : ndarray, shape (m + 1,)
        Times [s], rising.
    coefficients : ndarray, shape (order + 1, m)
        Of each piece, highest power first [rad, m for a prismatic joint; N m for a torque].
    side : {"motor", "output", "torque"}
        What is prescribed: the motor's angle over the ratio, the link's own angle, or the motor's torque
        times the ratio; motors driven by torque stand at their rest angle until the start.
    """

    breaks: Floats
    coefficients: Floats
    side: str = "motor"

    def __post_init__(self) -> None:
        if self.side not in _KINDS:
            raise InvalidParameter(f"must be one of {', '.join(_KINDS)}, got {self.side!r}", where="side")
        for name in ("breaks", "coefficients"):
            array = np.array(getattr(self, name), dtype=float)
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @property
    def kind(self) -> _core.DriveKind:
        """What the core calls `side`."""
        return _KINDS[self.side]

    @cached_property
    def digest(self) -> bytes:
        """Of the numbers, for `Drive.sha256`: identification runs one drive many times."""
        return hashlib.sha256(self.breaks.tobytes() + self.coefficients.tobytes()).digest()

    def polynomial(self) -> _core.PiecewisePolynomial:
        """The same for the core."""
        return _core.PiecewisePolynomial(self.breaks, self.coefficients)

    def __call__(self, time: ArrayLike) -> Floats:
        """Values at times [s]."""
        t = np.clip(np.asarray(time, dtype=float), self.breaks[0], self.breaks[-1])
        i = np.clip(np.searchsorted(self.breaks, t, side="right") - 1, 0, len(self.breaks) - 2)
        value: Floats = np.zeros_like(t)
        for row in self.coefficients:
            value = value * (t - self.breaks[i]) + row[i]
        return value


_KINDS = {
    "motor": _core.DriveKind.motor_angle,
    "output": _core.DriveKind.link_angle,
    "torque": _core.DriveKind.torque,
    "command": _core.DriveKind.torque,
}


@dataclass(frozen=True)
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
    """

    joints: Mapping[str, JointDrive]
    rest: Mapping[str, float] = field(default_factory=dict)
    start: float = 0.0
    end: float = 0.0

    def sha256(self) -> str:
        """Hash of all that a run takes from the drive, for its provenance."""
        found = hashlib.sha256(repr((sorted(self.rest.items()), self.start, self.end)).encode())
        for name, joint in sorted(self.joints.items()):
            found.update(f"{name} {joint.side}".encode() + joint.digest)
        return found.hexdigest()

    @classmethod
    def from_samples(cls, time: ArrayLike, values: Mapping[str, ArrayLike], side: str = "motor") -> Drive:
        """Exact samples, joined by a cubic spline (not-a-knot) and held before and after.

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
        if t.ndim != 1 or len(t) < 2 or not np.all(np.isfinite(t)) or np.any(np.diff(t) <= 0):
            raise InvalidParameter("must be at least two finite, rising times [s]", where="time")
        joints = {}
        for name, samples in values.items():
            y = np.asarray(samples, dtype=float)
            if y.shape != t.shape or not np.all(np.isfinite(y)):
                raise InvalidParameter(f"needs {len(t)} finite values, one a time", where=name)
            joints[name] = _held(t, y) if side == "command" else JointDrive(*interpolate(t, y), side)
        return cls(joints, start=float(t[0]), end=float(t[-1]))

    @classmethod
    def from_csv(cls, path: str | Path, arm: Arm) -> Drive:
        """A CSV file with `time_s` and one column per driven joint, named after it.

        Raises
        ------
        InvalidFile
            With line and column of what is wrong.
        """
        table = CsvFile(Path(path), path)
        if "time_s" not in table.header:
            raise InvalidFile(path, "header", f"has no column time_s; there are {', '.join(table.header)}")
        moving = [joint.name for joint in arm.moving_joints]
        names = [name for name in table.header if name != "time_s"]
        for name in names:
            if name not in moving:
                raise InvalidFile(
                    path, f"column {name}", f"is no moving joint of the model; there are {', '.join(moving)}"
                )
        if not names:
            raise InvalidFile(path, "header", f"drives no joint; add a column named {' or '.join(moving)}")
        rows = table.numbers(["time_s", *names])
        if len(rows) < 2:
            raise InvalidFile(path, "file", f"needs at least two rows of numbers, got {len(rows)}")
        wrong = np.argwhere(~np.isfinite(rows))
        if len(wrong):
            row, column = wrong[0]
            where = f"line {table.line(int(row))}, column {['time_s', *names][column]}"
            raise InvalidFile(path, where, "must be a finite number; a drive has no drop-outs")
        time = rows[:, 0]
        backward = np.flatnonzero(np.diff(time) <= 0)
        if len(backward):
            k = int(backward[0]) + 1
            where = f"line {table.line(k)}, column time_s"
            raise InvalidFile(path, where, f"times must rise, got {time[k]:g} s after {time[k - 1]:g} s")
        return cls.from_samples(time, {name: rows[:, i] for i, name in enumerate(names, 1)})

    @classmethod
    def from_record(cls, record: Record, arm: Arm) -> Drive:
        """The drive signals of a record: angles smoothed by their stated noise, commands held.

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
        if record.kind == "static":
            raise InvalidParameter(
                'is "static": poses do not move the arm; allowed as a drive is a record of kind "motion"',
                where="kind",
            )
        joints: dict[str, JointDrive] = {}
        start = _start(record, arm)
        for name in record.drive:
            signal = record.signals[name]
            if signal.quantity not in ("joint_angle", "joint_command") or signal.joint is None:
                raise InvalidParameter(
                    f"signal {name!r} ({signal.quantity}) cannot drive; a joint_angle drives directly, a "
                    "joint_command through the joint's controller",
                    where="drive",
                )
            if signal.joint in joints:
                raise InvalidParameter(f"joint {signal.joint!r} is driven twice", where="drive")
            samples = _true_samples(signal, arm, start)
            command = signal.quantity == "joint_command"
            joints[signal.joint] = (
                _held(samples.time, samples.values) if command else _smoothed(signal, arm, samples)
            )
        spans = [_span(signal, record, arm, start) for signal in record.signals.values() if len(signal.time)]
        known = [span for span in spans if span is not None]
        if not known:
            raise InvalidParameter("holds no times of a known clock", where="signals")
        starts = [drive.breaks[0] for drive in joints.values()] or [first for first, _ in known]
        end = max(last for _, last in known) + _AFTER_THE_LAST
        return cls(joints, dict(record.joints), float(min(starts)), float(end))

    def at_inputs(self, arm: Arm) -> Drive:
        """The same motion with angles at outputs of gears moved to their inputs, which hold the motors."""
        joints = dict(self.joints)
        for _ in arm.gears:  # as often as there are gears, for trains of them
            for gear in arm.gears:
                moved = joints.get(gear.output)
                if moved is not None and moved.side == "motor" and gear.input not in joints:
                    del joints[gear.output]
                    joints[gear.input] = replace(moved, coefficients=gear.ratio * moved.coefficients)
        return replace(self, joints=joints)


_AFTER_THE_LAST = 0.02
"""A run goes on so long after the last stamp [s], for clocks that are late."""


def _start(record: Record, arm: Arm) -> float:
    """True instant of the first sample that drives, from which drifts count; 0 where nothing drives."""
    drives = [record.signals[name] for name in record.drive]
    firsts = [
        float(signal.time[signal.valid][0]) - effects_of(arm, signal).delay
        for signal in drives
        if signal.valid.any() and len(signal.time)
    ]
    return min(firsts, default=0.0)


def true_time(signal: Signal, arm: Arm, start: float, late: float = 0.0) -> Floats:
    """Instants of a signal in a run that starts at `start`, where its clock is stated to be `late` [s]."""
    return effects_of(arm, signal).clock(ClockError(delay=late), start).instants(signal.time)


def _span(signal: Signal, record: Record, arm: Arm, start: float) -> tuple[float, float] | None:
    """First and last instant of a signal; None where its clock is unknown."""
    clock = record.clocks[signal.clock]
    if clock.unknown:
        return None
    instants = true_time(signal, arm, start, clock.offset)
    return float(instants[0]), float(instants[-1])


class _Samples(NamedTuple):
    """A drive's samples: true instants and values, the stamps and readings they were, noise of the latter."""

    time: Floats
    values: Floats
    stamps: Floats
    reading: Floats
    noise: float


def _true_samples(signal: Signal, arm: Arm, start: float) -> _Samples:
    """The samples of a drive without drop-outs and outliers."""
    seen = effects_of(arm, signal)
    reading, noise = signal.values[:, 0], float(seen.noise(signal.noise_std or 0.0)[0])
    true = seen.true(signal.values)[:, 0]
    good = np.isfinite(true)
    if (off := seen.outliers()) is not None:
        good &= ~drive_outliers(reading, noise, off)
    if not good.any():
        names = ", ".join(effect.name for effect in (*seen.before, *seen.after)) or "drop-outs"
        raise InvalidParameter(
            f"signal {signal.name!r} cannot drive: {names} leave no value of it", where="drive"
        )
    time = true_time(signal, arm, start)
    return _Samples(time[good], true[good], signal.time[good], reading[good], noise)


def _smoothed(signal: Signal, arm: Arm, samples: _Samples) -> JointDrive:
    """Joint angle of a signal, without its noise."""
    joint = arm.joint(str(signal.joint))
    shown = (samples.stamps, samples.reading)
    breaks, coefficients = smooth(samples.time, samples.values, samples.noise, shown)
    return JointDrive(breaks, coefficients, "output" if signal.side == "output" and joint.moves else "motor")


def _held(time: Floats, values: Floats) -> JointDrive:
    """A command: every sample holds until the next one."""
    return JointDrive(np.append(time, time[-1] + 1.0), values[None, :], "command")
