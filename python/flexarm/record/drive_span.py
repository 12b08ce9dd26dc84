"""Check that the angles that drive a record are known while its other signals tell of a motion.

A run holds a drive before its first sample and after its last, and a spline joins the samples between. Let a
drive be unknown from a to b: before it begins, in a pause, or after it ends. An error is

    a moving end    samples next to a or b move by more than `MOVED`; across a pause, the cubics through the
                    samples on either side differ by so much in its middle                            (1)
    a moving arm    a position, an angle or an orientation moves between a and b by more than
                    `STILL` of its whole range: the drive stood at a, and went on later               (2)

A drive that is at rest at its end is thus held, as the arm stands, or rings down. An end may differ by
`LATE`, `PAUSE` samples and three sigma of the clocks: a clock that is late is found by a diagnosis. Of a
signal whose clock is unknown only durations count: it may not move for longer than the drive lasts.     (3)
A command holds until the next one, so that it has no pause.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import Polynomial

from flexarm.arrays import Floats
from flexarm.errors import Problem

if TYPE_CHECKING:
    from flexarm.record.record import Record
    from flexarm.record.signal import Signal

MOVED = 1e-3
"""Motion of a drive that is no rest [rad or m]."""
NOISY = 12.0
"""The same over its noise: the range of a million samples, with a margin."""
PAUSE = 20
"""Usual intervals of a drive that are no pause yet, and samples that tell whether it stands."""
LATE = 0.25
"""Unstated delay of a clock that a diagnosis finds by itself [s]."""
STILL = 0.1
"""Part of its range by which what is not driven may still move: it rings down."""
PLACES = ("position", "orientation", "inclination", "joint_angle", "deflection")
"""Quantities that stand still with the arm."""

ALLOWED = "a drive must cover the motion of the other signals: complete it, or leave their rows out"


def uncovered(record: Record) -> list[Problem]:
    """Return what a motion record's other signals show while a joint angle that drives it is unknown.

    Parameters
    ----------
    record : Record
        Of kind "motion"; records of poses have no times.
    """
    return [problem for drive in _angles(record) for problem in _problems(record, drive)]


def single_values(record: Record) -> list[Problem]:
    """Return the joint angles that drive a motion record and hold a single value."""
    return [
        Problem(
            f"signals.{drive.name}",
            f"drives, and holds a single value, {drive.values[drive.valid, 0][0]:g} {drive.unit}; allowed "
            "are two or more, or, of a joint that stands still, its place in [joints] instead of a drive",
        )
        for drive in _angles(record)
        if drive.valid.sum() == 1
    ]


def _angles(record: Record) -> list[Signal]:
    """Return the joint angles that drive and hold a value."""
    drives = (record.signals[name] for name in record.drive)
    return [drive for drive in drives if drive.quantity == "joint_angle" and drive.valid.any()]


def _problems(record: Record, drive: Signal) -> Iterable[Problem]:
    """Return the first stretch over which a drive is unknown, and the signal that shows most of it."""
    where = f"signals.{drive.name}"
    time, values = drive.time[drive.valid], drive.values[drive.valid, 0]
    usual = float(np.median(np.diff(time)))
    others = [s for s in record.signals.values() if s is not drive and s.valid.any()]
    still = max(MOVED, NOISY * (drive.noise_std or 0.0))
    for k in (-1, *np.flatnonzero(np.diff(time) > PAUSE * usual).tolist(), len(time) - 1):
        first = time[k] if k >= 0 else -np.inf
        last = time[k + 1] if k + 1 < len(time) else np.inf
        moves = _moves(time, values, k, still)
        seen = [each for s in others if (each := _seen(record, drive, s, first, last, moves))]
        if seen:
            yield Problem(where, f"{_when(first, last)} {max(seen)[1]}; {ALLOWED}")
            return
    lasts = float(time[-1] - time[0])
    for other in (each for each in others if _unrelated(record, drive, each)):
        moving = _moving_for(other)
        if moving > lasts + _slack(record, drive, other):  # (3)
            what = f"lasts {lasts:.6g} s, {other.name} moves for {moving:.6g} s"
            yield Problem(where, f"{what} by a clock of unknown offset; {ALLOWED}")
            return


def _when(first: float, last: float) -> str:
    """Say when a drive is unknown."""
    if np.isinf(first):
        return f"begins at {last:.6g} s,"
    if np.isinf(last):
        return f"ends at {first:.6g} s,"
    return f"pauses from {first:.6g} to {last:.6g} s,"


def _moves(time: Floats, values: Floats, k: int, still: float) -> bool:
    """Return True if a drive moves where it is unknown after its sample k, see (1)."""
    before, after = slice(max(k + 1 - PAUSE, 0), k + 1), slice(k + 1, k + 1 + PAUSE)
    sides = [values[side] for side in (before, after) if len(values[side])]
    if len(sides) == 1:
        return float(np.ptp(sides[0])) > still
    middle, long = (time[k] + time[k + 1]) / 2, time[k + 1] - time[k]
    near = [(time >= time[k] - long) & (time <= time[k]), (time > time[k]) & (time <= time[k + 1] + long)]
    met = []
    for rows, side in zip(near, (before, after), strict=True):
        t, y = (time[rows], values[rows]) if rows.sum() >= PAUSE else (time[side], values[side])
        order = min(3, max(len(t) // 4, 0))
        met.append(float(Polynomial.fit(t, y, order)(middle)) if len(t) > 1 else float(y[0]))
    return abs(met[0] - met[1]) > still


def _seen(
    record: Record, drive: Signal, other: Signal, first: float, last: float, moves: bool
) -> tuple[float, str] | None:
    """Return how long a signal is seen while a drive is unknown [s], and that in words; None if it is not."""
    if _unrelated(record, drive, other):
        return None
    instants = other.time - _offset(record, other) + _offset(record, drive)
    slack = 0.0 if np.isfinite(first) and np.isfinite(last) else _slack(record, drive, other)
    inside = other.valid & (instants > first + slack) & (instants < last - slack)
    if not inside.any() or not (moves or _moved(other, inside)):
        return None
    begin, end = instants[inside][0], instants[inside][-1]
    return float(end - begin), f"{other.name} is seen from {begin:.6g} to {end:.6g} s by the drive's clock"


def _moved(signal: Signal, rows: Floats) -> bool:
    """Return True if a signal moves in these rows by more than (2) allows."""
    if signal.quantity not in PLACES:
        return False
    values, noise = signal.values[signal.valid], NOISY * (signal.noise_std or 0.0)
    ranges = np.ptp(values, axis=0)
    return bool(np.max(np.ptp(signal.values[rows], axis=0)) > max(STILL * float(np.max(ranges)), noise))


def _moving_for(signal: Signal) -> float:
    """Return how long a signal moves: from where it leaves its first place to where it comes to its last."""
    if signal.quantity not in PLACES:
        return 0.0
    time, values = signal.time[signal.valid], signal.values[signal.valid]
    far = max(STILL * float(np.max(np.ptp(values, axis=0))), NOISY * (signal.noise_std or 0.0))
    left = np.flatnonzero(np.max(np.abs(values - values[0]), axis=1) > far)
    away = np.flatnonzero(np.max(np.abs(values - values[-1]), axis=1) > far)
    return float(time[away[-1]] - time[left[0]]) if len(left) and len(away) else 0.0


def _unrelated(record: Record, drive: Signal, other: Signal) -> bool:
    """Return True if the offset between the clocks of two signals is unknown."""
    return drive.clock != other.clock and any(record.clocks[s.clock].unknown for s in (drive, other))


def _offset(record: Record, signal: Signal) -> float:
    clock = record.clocks[signal.clock]
    return 0.0 if clock.unknown else clock.offset


def _slack(record: Record, drive: Signal, other: Signal) -> float:
    """Return by how much the ends of two signals may differ [s]."""
    usual: Sequence[float] = [
        PAUSE / drive.rate_hz if len(drive.time) > 1 else 0.0,
        1 / other.rate_hz if len(other.time) > 1 else 0.0,
    ]
    sigmas = [0.0 if record.clocks[s.clock].unknown else record.clocks[s.clock].sigma for s in (drive, other)]
    return max(LATE, *usual) + 3 * float(np.hypot(*sigmas))
