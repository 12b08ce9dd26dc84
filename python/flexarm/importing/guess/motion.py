"""How well columns agree with the motion of the model: of its rigid arm, along the joints' columns.

A point's speed does not depend on the frame in which it is measured. So columns are compared by the size of
the motion and by the correlation of speeds over all lags,

    s = |x(t + h) - x(t)| / h,     r = max_lag corr(s_measured(t + lag), s_model(t))                     (1)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.kinematics import link_pose
from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter, NotConverged
from flexarm.statics.batch import StaticsBatch

ALIKE_SPEEDS = 0.8
"""Correlation of speeds from which on a measured motion is taken for one of the model."""
ROWS = 4000
"""Instants of the grid on which motions are compared."""


@dataclass(frozen=True)
class Track:
    """A motion: stamps [s] from the start, and values of one or more channels."""

    time: Floats
    values: Floats
    poses: bool = False
    """True if rows are poses, which the stamps count."""

    @classmethod
    def of(cls, time: Floats, columns: Sequence[Floats], poses: bool = False) -> Track:
        """Return the rows that hold values and whose stamps rise."""
        values = np.stack(columns, axis=1)
        keep = np.isfinite(values).all(axis=1) & np.isfinite(time)
        time, values = time[keep], values[keep]
        if len(time) > 1:
            latest = np.maximum.accumulate(time)
            rising = np.concatenate([[True], latest[1:] > latest[:-1]])
            time, values = time[rising], values[rising]
        return cls(time, values, poses)

    def at(self, time: Floats) -> Floats:
        """Return values at instants, between the stamps by straight lines."""
        return np.stack([np.interp(time, self.time, column) for column in self.values.T], axis=1)

    @property
    def size(self) -> float:
        """Root mean square of the distance from the mean."""
        away = self.values - self.values.mean(axis=0)
        return float(np.sqrt(np.mean(np.sum(away**2, axis=1))))


@dataclass(frozen=True)
class Agreement:
    """How a measured motion goes with one of the model: (1), the lag [s], and the model's size over it.

    The lag is how late the measured stamps are, both counted as in their tracks.
    """

    correlation: float
    lag: float
    ratio: float


def rigid_track(
    arm: Arm, point: str, joints: Mapping[str, Track], axes: Sequence[int], rows: int = ROWS
) -> Track:
    """Return the motion of a point of the rigid arm along its joints [m], at so many instants, or poses."""
    start = max(track.time[0] for track in joints.values())
    end = min(track.time[-1] for track in joints.values())
    first = next(iter(joints.values()))
    rows = min(rows, 200) if arm.closures else rows  # each closes the loops anew
    time = first.time if first.poses else np.linspace(start, end, rows)
    values = {name: track.at(time)[:, 0] for name, track in joints.items()}
    seen = (_of_loops if arm.closures else _of_chain)(arm, point, values)
    closed = np.isfinite(seen).all(axis=1)
    if closed.sum() < 2:  # as if the point rested
        return Track(time[[0, -1]], np.zeros((2, len(axes))), first.poses)
    return Track(time[closed], seen[closed][:, list(axes)], first.poses)


def _of_chain(arm: Arm, point: str, values: Mapping[str, Floats]) -> Floats:
    """Return where a point of the rigid arm is, shape (n, 3) [m]."""
    place, count = arm.point(point), len(next(iter(values.values())))
    seen = link_pose(arm, place.link, values).of_point(np.asarray(place.position))
    return np.broadcast_to(seen, (count, 3))


def _of_loops(arm: Arm, point: str, values: Mapping[str, Floats]) -> Floats:
    """Return the same where the arm closes loops and weighs nothing; NaN where these cannot be closed."""
    statics = StaticsBatch(arm.replace(gravity=(0.0, 0.0, 0.0), effects=()), driven=tuple(values))
    k = [each.name for each in arm.points].index(point)
    found = np.full((len(next(iter(values.values()))), 3), np.nan)
    for row in range(len(found)):
        with suppress(NotConverged, InvalidParameter):
            closed = statics.at({name: float(each[row]) for name, each in values.items()})
            found[row] = closed.arrays["position"][k]
    return found


def agreement(measured: Track, predicted: Track, rows: int = ROWS) -> Agreement:
    """Return how a measured motion goes with one of the model, on a grid of so many instants.

    Poses have no lag; distances from one to the next stand for speeds.
    """
    overlap = 0.5  # least share of the shorter motion that a lag must leave
    ratio = predicted.size / measured.size if measured.size > 0 else 0.0
    if measured.poses:
        one, other = (_distances(track.at(measured.time)) for track in (measured, predicted))
        return Agreement(_correlation(one, other), 0.0, ratio)
    step = max(measured.time[-1], predicted.time[-1]) / rows
    one, other = (_speeds(track, step) for track in (measured, predicted))
    if min(len(one), len(other)) < 8 or one.std() == 0 or other.std() == 0:
        return Agreement(0.0, 0.0, ratio)
    best, lag = -1.0, 0
    most = int((1 - overlap) * min(len(one), len(other)))
    for k in range(-most, most + 1 + abs(len(one) - len(other))):
        a, b = one[max(k, 0) :], other[max(-k, 0) :]
        n = min(len(a), len(b))
        if n < overlap * min(len(one), len(other)):
            continue
        found = _correlation(a[:n], b[:n])
        if found > best:
            best, lag = found, k
    return Agreement(best, lag * step + float(measured.time[0] - predicted.time[0]), ratio)


def _correlation(a: Floats, b: Floats) -> float:
    """Return the correlation of two series; -1 if one does not vary."""
    a, b = a - a.mean(), b - b.mean()
    size = float(np.linalg.norm(a) * np.linalg.norm(b))
    return float(a @ b) / size if size > 0 else -1.0


def _speeds(track: Track, step: float) -> Floats:
    """Return speeds on a grid that starts with the motion."""
    return _distances(track.at(np.arange(track.time[0], track.time[-1], step))) / step


def _distances(values: Floats) -> Floats:
    """Return distances from each row to the next."""
    found: Floats = np.linalg.norm(np.diff(values, axis=0), axis=1)
    return found


def white_noise(values: Floats) -> float:
    """Return 1 sigma of white noise by third differences, the median over pieces; 0 if it shows none."""
    values = values[np.isfinite(values)]
    if len(values) < 8:
        return 0.0
    third = np.diff(values, 3)
    pieces = np.array_split(third, max(1, min(20, len(third) // 20)))
    return float(np.median([np.sqrt(np.mean(piece**2)) for piece in pieces]) / np.sqrt(20))
