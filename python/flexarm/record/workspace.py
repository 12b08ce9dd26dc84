"""Workspace of the rigid arm along a record: positions of its points, and the distance that they reach."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexarm.arm.kinematics import link_pose
from flexarm.arm.sizes import reach
from flexarm.arrays import Floats

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.record.record import Record
    from flexarm.record.signal import Signal


def rigid_places(record: Record, arm: Arm, point: str) -> Floats:
    """Return positions of a point of the rigid arm along the recorded joint angles, shape (n, 3) [m].

    Joints that no angle drives stand as the record says.
    """
    rows = {name: each[_looks(len(each))] for name, each in _drives(record).items()}
    return _places(record, arm, point, rows)


def span_by(record: Record, arm: Arm, drive: str, point: str) -> float:
    """Return the range over which one drive alone moves a point of the rigid arm [m]."""
    rows = {name: each[_looks(len(each)) * (name == drive)] for name, each in _drives(record).items()}
    return float(np.max(np.ptp(_places(record, arm, point, rows), axis=0)))


def predicted_places(record: Record, arm: Arm, signal: Signal) -> list[Floats]:
    """Return rigid positions at the readings of a signal, for each plausible offset of its clock."""
    rows = np.flatnonzero(signal.valid)
    rows = rows[_looks(len(rows))]
    if signal.pose is not None:
        return [_places(record, arm, str(signal.point), _rows_of_poses(record, signal.pose[rows]))]
    return [
        _places(record, arm, str(signal.point), _rows_at(record, signal.time[rows] - late))
        for late in _late(record, signal)
    ]


def _places(record: Record, arm: Arm, point: str, rows: Mapping[str, NDArray[np.intp]]) -> Floats:
    """Return rigid positions of a point at rows of the drives, by name."""
    count = len(next(iter(rows.values()))) if rows else 1
    values = {joint.name: np.full(count, record.joints.get(joint.name, 0.0)) for joint in arm.joints}
    for name, each in rows.items():
        if record.signals[name].quantity == "joint_angle":
            values[str(record.signals[name].joint)] = record.signals[name].values[each, 0]
    place = arm.point(point)
    return np.asarray(link_pose(arm, place.link, values).of_point(np.asarray(place.position)))


def _looks(count: int) -> NDArray[np.intp]:
    looks = 101  # instants at which a motion is looked at
    return np.round(np.linspace(0, 1, looks) * (count - 1)).astype(int)


def _drives(record: Record) -> dict[str, NDArray[np.intp]]:
    """Return rows with a value of every drive that has some."""
    rows = {name: np.flatnonzero(record.signals[name].valid) for name in record.drive}
    return {name: each for name, each in rows.items() if len(each)}


def _rows_of_poses(record: Record, poses: NDArray[np.str_]) -> dict[str, NDArray[np.intp]]:
    """Return a row of each drive for each of these poses that all drives hold."""
    first = {
        name: {str(record.signals[name].pose[row]): row for row in rows[::-1]}  # type: ignore[index]
        for name, rows in _drives(record).items()
    }
    known = [pose for pose in map(str, poses) if all(pose in each for each in first.values())]
    return {name: np.array([each[pose] for pose in known]) for name, each in first.items() if known}


def _rows_at(record: Record, instants: Floats) -> dict[str, NDArray[np.intp]]:
    """Return the last row of each drive before each instant, or its first."""
    found = {}
    for name, rows in _drives(record).items():
        at = np.searchsorted(record.instants(record.signals[name])[rows], instants, side="right") - 1
        found[name] = rows[at.clip(0)]
    return found


def _late(record: Record, signal: Signal) -> list[float]:
    """Return plausible offsets of a clock [s]: as stated, or from a common begin or end with the drives."""
    sure = 3.0  # sigmas of a clock that its stamps may be off by
    clock = record.clocks[signal.clock]
    if not clock.unknown:
        return [clock.offset + k * sure * clock.sigma for k in (0, -1, 1)]
    drives = [record.instants(record.signals[name])[rows] for name, rows in _drives(record).items()]
    first, last = min((t[0] for t in drives), default=0.0), max((t[-1] for t in drives), default=0.0)
    return [float(signal.time[0] - first), float(signal.time[-1] - last)]


def farthest_point(record: Record, arm: Arm) -> float:
    """Return the greatest distance of points of the rigid arm from the base [m]; 0 without points."""
    places = (rigid_places(record, arm, point.name) for point in arm.points)
    return max((float(np.max(np.linalg.norm(place, axis=1))) for place in places), default=0.0)


def workspace_radius(record: Record, arm: Arm) -> float:
    """Return the greatest distance of any point from the base [m], including joints that slide."""
    return max(reach(arm), farthest_point(record, arm))
