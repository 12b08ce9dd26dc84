"""Plausibility rules of records: units, dead channels, missing noise."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm.joint import shaft_ratio
from flexarm.errors import Problem
from flexarm.record.drive_span import single_values, uncovered
from flexarm.record.frame_plausibility import frame_rotation_problems
from flexarm.record.noise_plausibility import clock_problems, noise_problems
from flexarm.record.signal import Signal
from flexarm.record.table import Frame
from flexarm.record.time_unit import duration_problems, mismatched_durations
from flexarm.wording import stamp

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.record.record import Record


INPUTS = ("force", "payload_mass")
"""Quantities that say what an arm was told and are compared with nothing."""
FARTHEST = 4 * pi
"""Angle that hardly any joint reaches at its output [rad]: wrists of robots turn by 7 rad."""


def validate(record: Record, arm: Arm | None = None) -> Iterable[Problem]:
    """Yield implausible values of a record; an arm tells the ratios of its gears."""
    if record.kind == "motion" and not record.drive and record.initial != "moving":
        what = "is not given: nothing drives the joints, all stand still; of a tap, pluck or drop test say "
        yield Problem("drive", what + 'initial = "moving"')
    if record.kind == "frequency_response":
        yield from _responses(record)
        return
    yield from disjoint_clocks(record)
    if record.kind == "motion":
        yield from duration_problems(record)
    yield from (Problem(f"signals.{name}", what) for name, what in disjoint_signals(record).items())
    if record.kind == "static" and not record.drive and record.of_quantity("joint_angle"):
        names = ", ".join(record.of_quantity("joint_angle"))
        yield Problem("drive", f"is not given: joint angles ({names}) are compared and place no joint")
    yield from unit_problems(record, arm)
    yield from frame_rotation_problems(record)
    yield from clock_problems(record)
    for signal in record.signals.values():
        where = f"signals.{signal.name}"
        if not signal.valid.any():
            lost = signal.empty if len(signal.empty) < signal.values.shape[1] else ()
            along = f" along {', '.join(lost)}" if lost else ""
            yield Problem(where, f"holds no value{along} in {len(signal)} rows")
            continue
        yield from (Problem(where, what) for what in (*_dead(signal), *_gaps(signal)))
        yield from noise_problems(signal)
        if signal.noise_std is None and signal.name not in record.drive and signal.quantity not in INPUTS:
            yield Problem(
                f"{where}.noise_std", "is not given: a gap in this signal cannot be weighed against its noise"
            )


def _responses(record: Record) -> Iterable[Problem]:
    """Yield frequency responses without values, or of which no noise is stated."""
    for signal in (each for each in record.signals.values() if each.input):
        where = f"signals.{signal.name}"
        if not signal.valid.any():
            yield Problem(where, f"holds no value in {len(signal)} rows")
        elif signal.noise_std is None and signal.coherence is None:
            what = "is not given, nor a coherence: a gap in this signal cannot be weighed against its noise"
            yield Problem(f"{where}.noise_std", what)


def unit_problems(record: Record, arm: Arm | None = None) -> Iterable[Problem]:
    """Yield values that no sensor shows in the unit that is stated.

    Gears of the arm are between the shafts of motors and what they turn.
    """
    for name, frame in record.frames.items():
        if max(map(abs, frame.rpy)) > 2 * pi:
            yield Problem(f"frames.{name}.rpy", f"is {list(frame.rpy)} rad; write degrees as radians")
    for signal in record.signals.values():
        if signal.valid.any():
            ratio = shaft_ratio(signal.joint, arm.gears) if arm is not None else 1.0
            found = [*_unit(signal, ratio)]
            if signal.quantity == "position" and arm is None:  # else `compatibility` has its reach
                found += _distant(signal, is_remote(record.frame_of(signal)))
            yield from (Problem(f"signals.{signal.name}", what) for what in found)


def is_remote(frame: Frame) -> bool:
    """Return True if positions in a frame may be far from those in the base, as with a tracker or a map."""
    return frame.unknown or any(frame.xyz)


def disjoint_clocks(record: Record) -> Iterable[Problem]:
    """Yield signals of another clock without an instant in common with the drive."""
    for signal, times, own in _apart(record):
        if signal.clock != own:
            yield Problem(
                f"signals.{signal.name}",
                f"{times} by {own!r}: they have no instant in common; state the offset in "
                f'clocks.{signal.clock}, or that the clock is "unknown"',
            )


def unknown_motion(record: Record) -> list[Problem]:
    """Return drives of a single value, or motions of other signals while a drive is unknown.

    Skip signals disjoint from the drive, and records with a wrong unit of time.
    """
    if record.kind != "motion":
        return []
    if (single := single_values(record)) or mismatched_durations(record):
        return single
    apart = [signal.name for signal, *_ in _apart(record)]
    return uncovered(record, [s for s in record.signals.values() if s.name not in apart])


def disjoint_signals(record: Record) -> dict[str, str]:
    """Return signals of the drive's clock without an instant in common with it, and a remedy."""
    return {
        signal.name: f"{times} by the same: they have no instant in common; if the stamps are not of one "
        'clock, give the signal its own, with its offset or "unknown"'
        for signal, times, own in _apart(record)
        if signal.clock == own
    }


def _apart(record: Record) -> Iterable[tuple[Signal, str, str]]:
    """Yield signals without an instant in common with the drive, a text on both, and the drive's clock."""
    drives = [record.signals[name] for name in record.drive]
    known = [s for s in drives if len(s.time) and not record.clocks[s.clock].unknown]
    if record.kind != "motion" or not known:
        return
    own, first, last = known[0].clock, *_ran(record, known)
    for signal in record.signals.values():
        if record.clocks[signal.clock].unknown or not len(signal.time):
            continue
        start, end = _ran(record, [signal])
        margin = 0.0 if signal.clock == own else 3 * record.clocks[signal.clock].sigma
        if start - margin > last or end + margin < first:
            times = (
                f"runs from {stamp(start)} to {stamp(end)} s by clock {signal.clock!r}, the drive from "
                f"{stamp(first)} to {stamp(last)} s"
            )
            yield signal, times, own


def _ran(record: Record, signals: Sequence[Signal]) -> tuple[float, float]:
    """Return the first and last instant of signals by their stated clocks [s]."""
    late = [record.clocks[signal.clock].offset for signal in signals]
    first = min(signal.time[0] - by for signal, by in zip(signals, late, strict=True))
    last = max(signal.time[-1] - by for signal, by in zip(signals, late, strict=True))
    return float(first), float(last)


def _unit(signal: Signal, ratio: float) -> Iterable[str]:
    """Yield values that contradict their unit."""
    largest = float(np.nanmax(np.abs(signal.values)))
    turned = largest / ratio
    if signal.quantity in ("joint_angle", "joint_command") and signal.unit == "rad" and turned > FARTHEST:
        yield (
            f"reaches {turned:g} rad at the output, {turned / (2 * pi):.1f} turns; if the file holds "
            'degrees, say unit = "deg", if it holds the motor\'s own angle, divide it by the ratio'
        )
    if signal.quantity in ("joint_angle", "joint_command") and signal.unit == "rad":
        steps = np.abs(np.diff(signal.values[signal.valid, 0]))
        rolled = int(np.sum(np.abs(steps - 2 * pi) < 0.01 * 2 * pi))
        if rolled and np.median(steps) < 0.1 * 2 * pi:
            times = "once" if rolled == 1 else f"{rolled} times"
            yield f"jumps {times} by a turn between two rows, as a counter that rolls over; unwrap the angle"
    if signal.quantity == "inclination" and largest > 2 * pi:
        yield f'reaches {largest:g} rad; if the file holds degrees, say unit = "deg"'
    if signal.quantity == "orientation":
        lengths = np.linalg.norm(signal.values[signal.valid], axis=1)
        if len(lengths) and np.max(np.abs(lengths - 1)) > 0.01:
            worst = float(lengths[np.argmax(np.abs(lengths - 1))])
            yield f"a quaternion has length {worst:g}, it must be 1; channels are x, y, z, w"
    if signal.quantity == "acceleration" and len(signal.axes) == 3:
        typical = float(np.nanmedian(np.linalg.norm(signal.values, axis=1)))
        if 0.5 < typical < 2 or typical > 500:
            yield (
                f"has a typical magnitude of {typical:g} m/s2; specific force at rest is 9.81 m/s2; "
                'if the file holds multiples of g, say unit = "g"'
            )


def _distant(signal: Signal, elsewhere: bool) -> Iterable[str]:
    """Yield positions that no arm reaches, or further apart than that."""
    distant = 1000.0  # distance that no arm reaches or moves over [m]
    span = float(np.max(np.nanmax(signal.values, axis=0) - np.nanmin(signal.values, axis=0)))
    size, what = (span, "moves over") if elsewhere else (float(np.nanmax(np.abs(signal.values))), "reaches")
    if size > distant:
        yield f'{what} {size:g} m; if the file holds millimetres, say unit = "mm"'


def _dead(signal: Signal) -> Iterable[str]:
    """Yield channels that never change although their noise should make them.

    A joint at rest may show one count throughout; whether it moves is judged beside the model.
    """
    at_rest = signal.quantity in ("joint_angle", "joint_command")
    if at_rest or signal.pose is not None or len(signal) < 10 or not signal.noise_std:
        return
    for name, column in zip(signal.channels or ("",) * signal.values.shape[1], signal.values.T, strict=True):
        seen = column[np.isfinite(column)]
        if len(seen) > 9 and np.ptp(seen) == 0:
            which = f"channel {name!r} " if name else ""
            yield (
                f"{which}holds {seen[0]:g} {signal.unit} throughout, although its noise is "
                f"{signal.noise_std:g}"
            )


def _gaps(signal: Signal) -> Iterable[str]:
    """Yield pauses of more than twenty samples between stamps."""
    if len(signal.time) < 3:
        return
    steps = np.diff(signal.time)
    worst = int(np.argmax(steps))
    if steps[worst] > 20 * np.median(steps):
        yield (
            f"has a pause of {steps[worst]:.3g} s after row {worst}, "
            f"{signal.time[worst] - signal.time[0]:.6g} s after its first sample; "
            f"samples are usually {np.median(steps):.3g} s apart"
        )
