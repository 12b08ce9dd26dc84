"""Drive of a record.

A record holds the readings of an encoder and the stamps of its clock. Where the model has effects on them
(`flexarm.measurement.effects_of`), readings are turned into true angles and stamps into true time before the
samples are smoothed. The readings and their noise alone determine how much, so that the drive depends
smoothly on the parameters of these effects.

A run ends a little after the last stamp, for clocks that are late, or after a drive that still moves at its
last sample. Until then a drive goes on with the rate and acceleration of its last sample: a sudden stop would
show in the accelerations just before it.
"""

from __future__ import annotations

from math import inf
from typing import Any, NamedTuple

import numpy as np

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.drive.joint_drive import JointDrive
from flexarm.drive.lead_in import LEAD, led_in
from flexarm.errors import InvalidParameter
from flexarm.measurement.clocks import ClockError
from flexarm.measurement.drive_noise import with_drive_noise
from flexarm.measurement.effects_of import effects_of
from flexarm.measurement.outliers import drive_outliers
from flexarm.measurement.smoothing import Pieces, smooth
from flexarm.record import Record, Signal
from flexarm.record.drive_span import moves_at_end

AFTER = 0.02
"""Time after the last stamp at which a run ends [s]."""


def attributes_in(record: Record, arm: Arm) -> dict[str, Any]:
    """Return the attributes of the drive of a record, see `Drive.from_record`."""
    if record.kind != "motion":
        what = "poses do" if record.kind == "static" else "a frequency response does"
        raise InvalidParameter(
            f'is "{record.kind}": {what} not move the arm; allowed as a drive is a record of kind "motion"',
            where="kind",
        )
    record = with_drive_noise(record)[0]
    joints: dict[str, JointDrive] = {}
    told = [record.signals[name] for name in record.drive] or list(record.signals.values())
    firsts = [
        float(signal.time[signal.valid][0]) - late - effects_of(arm, signal).delay
        for signal in told
        if signal.valid.any() and len(signal.time) and (late := _lateness(signal, record)) is not None
    ]
    start = min(firsts, default=0.0)
    for name in record.drive:
        signal = record.signals[name]
        if signal.quantity not in ("joint_angle", "joint_command") or signal.joint is None:
            raise InvalidParameter(
                f"signal {name!r} ({signal.quantity}) cannot drive; a joint_angle drives directly, a "
                "joint_command through the joint's controller, directly where it has none",
                where="drive",
            )
        if signal.joint in joints:
            raise InvalidParameter(f"joint {signal.joint!r} is driven twice", where="drive")
        late = _lateness(signal, record)
        if late is None:
            raise InvalidParameter(
                f"has an unknown offset to that of the first drive, and signal {name!r} drives on it; state "
                "the offsets of both clocks",
                where=f"clocks.{signal.clock}",
            )
        joints[signal.joint] = _joint_drive(signal, arm, start, late)
    spans = [_span(signal, record, arm, start) for signal in record.signals.values() if len(signal.time)]
    known = [span for span in spans if span is not None]
    if not known:
        raise InvalidParameter("holds no times of a known clock", where="signals")
    lead = 0.0
    starts = [drive.breaks[0] for drive in joints.values()] or [first for first, _ in known]
    end = max(last for _, last in known) + AFTER
    if record.initial == "moving" and all(each.side != "command" for each in joints.values()):
        joints, lead = {name: led_in(each) for name, each in joints.items()}, LEAD
    return {
        "joints": joints,
        "rest": dict(record.joints),
        "start": float(min(starts)),
        "end": min(float(end), moving_end(record, arm, start)),
        "lead": lead,
    }


def moving_end(record: Record, arm: Arm, start: float) -> float:
    """Return when the first joint angle that drives is unknown while it moves [s]; infinite if all stop."""
    ends = [
        float(true_time(signal, arm, start, _lateness(signal, record) or 0.0)[signal.valid][-1])
        for signal in (record.signals[name] for name in record.drive)
        if signal.quantity == "joint_angle" and moves_at_end(signal)
    ]
    return min(ends, default=inf) + AFTER


def true_time(signal: Signal, arm: Arm, start: float, late: float = 0.0) -> Floats:
    """Return the instants of a signal in a run that starts at `start`, its clock stated to be `late` [s]."""
    return effects_of(arm, signal).clock(ClockError(delay=late), start).instants(signal.time)


def _lateness(signal: Signal, record: Record) -> float | None:
    """Return how late a signal's stamps are against those of the first drive [s]; None: unknown.

    The time of a run is that of the first drive's stamps.
    """
    own = next((record.signals[name].clock for name in record.drive), record.reference_clock)
    if signal.clock == own:
        return 0.0
    mine, its = record.clocks[signal.clock], record.clocks[own]
    return None if mine.unknown or its.unknown else mine.offset - its.offset


def _span(signal: Signal, record: Record, arm: Arm, start: float) -> tuple[float, float] | None:
    """Return the first and last instant of a signal; None where its clock is unknown."""
    late = _lateness(signal, record)
    if late is None:
        return None
    instants = true_time(signal, arm, start, late)
    return float(instants[0]), float(instants[-1])


def _joint_drive(signal: Signal, arm: Arm, start: float, late: float) -> JointDrive:
    """Return a command as its controller holds it, or an angle without its noise.

    Without a controller in the model a joint follows its command as it does an angle.
    """
    samples = _true_samples(signal, arm, start, late)
    controlled = any(controller.joint == signal.joint for controller in arm.controllers)
    if signal.quantity == "joint_command" and controlled:
        return JointDrive.held(samples.time, samples.values)
    joint = arm.joint(str(signal.joint))
    shown = (samples.stamps, samples.reading)
    breaks, coefficients = _gone_on(*smooth(samples.time, samples.values, samples.noise, shown))
    return JointDrive(breaks, coefficients, "output" if signal.side == "output" and joint.moves else "motor")


def _gone_on(breaks: Floats, coefficients: Floats) -> Pieces:
    """Return pieces and one more with the last rate and acceleration, until beyond the end of the run."""
    value, rate, acceleration = _core.PiecewisePolynomial(breaks, coefficients)(breaks[-1])
    last = np.array([0.0, acceleration / 2, rate, value])[-len(coefficients) :]
    return np.append(breaks, breaks[-1] + 2 * AFTER), np.column_stack([coefficients, last])


class _Samples(NamedTuple):
    """A drive's samples: true instants and values, the stamps and readings they were, noise of the latter."""

    time: Floats
    values: Floats
    stamps: Floats
    reading: Floats
    noise: float


def _true_samples(signal: Signal, arm: Arm, start: float, late: float) -> _Samples:
    """Return the samples of a drive without drop-outs and outliers."""
    seen = effects_of(arm, signal)
    reading, noise = signal.values[:, 0], float(seen.noise(signal.noise_std or 0.0)[0])
    true = seen.true(signal.values)[:, 0]
    good = np.isfinite(true)
    if (off := seen.outliers()) is not None:
        good &= ~drive_outliers(reading, noise, off)
    if not good.any():
        names = ", ".join(effect.name for effect in (*seen.before, *seen.after)) or "drop-outs"
        what = f"signal {signal.name!r} cannot drive: {names} leave no value of it"
        raise InvalidParameter(what, where="drive")
    time = true_time(signal, arm, start, late)
    return _Samples(time[good], true[good], signal.time[good], reading[good], noise)
