"""Check that the angles that drive a record are known while its other signals tell of a motion.

A run holds a drive before its first sample and after its last, and a spline joins the samples between. Let a
drive be unknown from a to b: before it begins, in a pause, or after it ends. An error is

    a moving end    samples next to a and b move by more than `range_at_rest`, and another signal is
                    seen; a pause is none in whose middle the cubics on either side meet within that  (1)
    a moving arm    samples next to a and b stand still, but a position, an angle or an orientation
                    moves between a and b by more than `still` of its whole range                     (2)

A drive that is at rest at its end is thus held, as the arm stands, or rings down. An end may differ by
`late`, `PAUSE` samples and three sigma of the clocks: a clock that is late is found by a diagnosis. Of a
signal whose clock is unknown only durations count: it may not move for longer than the drive lasts.     (3)
A command holds until the next one, so that it has no pause.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import hypot
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.polynomial import Polynomial

from flexarm.arrays import Floats
from flexarm.errors import Problem
from flexarm.wording import stamp

if TYPE_CHECKING:
    from flexarm.record.record import Record
    from flexarm.record.signal import Signal

NOISY, ONE_STEP = 12.0, 1.5
"""Its range at rest, in sigmas of a million samples and with a margin; and, if it is coarse, in steps."""
PAUSE = 20
"""Usual intervals of a drive that are no pause yet, and samples that tell whether it stands."""
PLACES = ("position", "orientation", "inclination", "joint_angle", "deflection")
"""Quantities that stand still with the arm."""

ALLOWED = "a drive must cover the motion of the other signals: complete it, or leave their rows out"


def range_at_rest(signal: Signal) -> float:
    """Return the range over which an angle's readings tell of no motion [rad or m]."""
    moved = 1e-3  # motion of an angle that is no rest [rad or m]
    return max(moved, NOISY * (signal.noise_std or 0.0), ONE_STEP * signal.finest_step)


def moves_at_end(drive: Signal) -> bool:
    """Return True if the last samples of a drive tell of a motion."""
    last = drive.values[drive.valid, 0][-PAUSE:]
    return len(last) > 0 and float(np.ptp(last)) > range_at_rest(drive)


def uncovered(record: Record, signals: Iterable[Signal]) -> list[Problem]:
    """Return what signals of a motion show while a joint angle that drives it is unknown."""
    seen = [signal for signal in signals if signal.valid.any()]
    return [problem for drive in _angles(record) for problem in _problems(record, drive, seen)]


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


def _problems(record: Record, drive: Signal, signals: Sequence[Signal]) -> Iterable[Problem]:
    """Return the first stretch over which a drive is unknown, and the signal that shows most of it."""
    where = f"signals.{drive.name}"
    time, values = drive.time[drive.valid], drive.values[drive.valid, 0]
    pauses = np.flatnonzero(np.diff(time) > PAUSE * np.median(np.diff(time)))
    others = [_beside(record, drive, signal) for signal in signals if signal.name != drive.name]
    still = range_at_rest(drive)
    for k in (-1, *pauses.tolist(), len(time) - 1):
        first = time[k] if k >= 0 else -np.inf
        last = time[k + 1] if k + 1 < len(time) else np.inf
        moves = float(np.ptp(values[max(k + 1 - PAUSE, 0) : k + 1 + PAUSE])) > still
        if moves and _meets(time, values, k, still):
            continue
        seen = [each for other in others if (each := other.seen(first, last, moves))]
        if seen:
            yield Problem(where, f"{_when(first, last)} {max(seen)[1]}; {ALLOWED}")
            return
    lasts = float(time[-1] - time[0])
    for other in others:
        if other.unrelated and (moving := other.moving_for()) > lasts + other.slack:  # (3)
            what = f"lasts {lasts:.6g} s, {other.name} moves for {moving:.6g} s"
            yield Problem(where, f"{what} by a clock of unknown offset; {ALLOWED}")
            return


class _Beside(NamedTuple):
    """Another signal: instants by the drive's clock and values of its valid rows.

    `far` is how far it may go while the drive is unknown, `slack` by how much ends may differ [s].
    """

    name: str
    time: Floats
    values: Floats
    far: float
    slack: float
    unrelated: bool

    def seen(self, first: float, last: float, moves: bool) -> tuple[float, str] | None:
        """Return how long it is seen while a drive is unknown [s], and that in words; None if it is not."""
        slack = 0.0 if np.isfinite(first) and np.isfinite(last) else self.slack
        begin = int(np.searchsorted(self.time, first + slack, side="right"))
        end = int(np.searchsorted(self.time, last - slack))
        rows = self.values[begin:end]
        if self.unrelated or not len(rows) or not (moves or np.max(np.ptp(rows, axis=0)) > self.far):
            return None
        t = self.time[begin], self.time[end - 1]
        return float(
            t[1] - t[0]
        ), f"{self.name} is seen from {stamp(t[0])} to {stamp(t[1])} s by the drive's clock"

    def moving_for(self) -> float:
        """Return how long it moves: from where it leaves its first place to where it comes to its last."""
        left = np.flatnonzero(np.max(np.abs(self.values - self.values[0]), axis=1) > self.far)
        away = np.flatnonzero(np.max(np.abs(self.values - self.values[-1]), axis=1) > self.far)
        return float(self.time[away[-1]] - self.time[left[0]]) if len(left) and len(away) else 0.0


def _beside(record: Record, drive: Signal, other: Signal) -> _Beside:
    """Return another signal beside a drive."""
    still = 0.1  # part of its range by which what is not driven may still move: it rings down
    late = 0.25  # unstated delay of a clock that a diagnosis finds by itself [s]
    clocks = [record.clocks[signal.clock] for signal in (drive, other)]
    unrelated = drive.clock != other.clock and any(clock.unknown for clock in clocks)
    own, its = (0.0 if clock.unknown else clock.offset for clock in clocks)
    sigma = 0.0 if unrelated or drive.clock == other.clock else hypot(*(clock.sigma for clock in clocks))
    sample = 1 / other.rate_hz if len(other.time) > 1 else 0.0
    values, far = other.values[other.valid], np.inf
    if other.quantity in PLACES:
        far = max(still * float(np.max(np.ptp(values, axis=0))), NOISY * (other.noise_std or 0.0))
    return _Beside(
        other.name,
        other.time[other.valid] - its + own,
        values,
        far,
        max(late, PAUSE / drive.rate_hz, sample) + 3 * sigma,
        unrelated,
    )


def _when(first: float, last: float) -> str:
    """Say when a drive is unknown."""
    if np.isinf(first):
        return f"begins at {stamp(last)} s,"
    if np.isinf(last):
        return f"ends at {stamp(first)} s,"
    return f"pauses from {stamp(first)} to {stamp(last)} s,"


def _meets(time: Floats, values: Floats, k: int, still: float) -> bool:
    """Return True if the cubics on both sides of a pause after sample k meet in its middle, see (1)."""
    if k < 0 or k + 1 == len(time):
        return False
    long, middle = time[k + 1] - time[k], (time[k] + time[k + 1]) / 2
    start = min(int(np.searchsorted(time, time[k] - long)), max(k + 1 - PAUSE, 0))
    stop = max(int(np.searchsorted(time, time[k + 1] + long)), k + 1 + PAUSE)
    sides = (slice(start, k + 1), slice(k + 1, stop))
    before, after = (_extrapolated(time[side], values[side], middle) for side in sides)
    return abs(before - after) <= still


def _extrapolated(time: Floats, values: Floats, at: float) -> float:
    """Return the value at an instant of the cubic through samples; of few samples, of a lower order."""
    return (
        float(Polynomial.fit(time, values, min(3, len(time) // 4))(at)) if len(time) > 1 else float(values[0])
    )
