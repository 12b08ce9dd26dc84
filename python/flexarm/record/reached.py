"""Where the rigid arm of a record is: places that what was measured cannot be far from."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm.sizes import reach
from flexarm.arrays import Floats

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.record.record import Record

LOOKS = 101
"""Instants at which a motion is looked at."""


def rigid_places(record: Record, arm: Arm, point: str) -> Floats:
    """Where the rigid arm has a point along the recorded joint angles, shape (n, 3) [m].

    Joints that no angle drives stand as the record says.
    """
    from flexarm.measurement.kinematics import link_pose

    place = arm.point(point)
    places = link_pose(arm, place.link, _angles(record, arm)).of_point(np.asarray(place.position))
    return np.asarray(places)


def _angles(record: Record, arm: Arm) -> dict[str, Floats]:
    values = {joint.name: np.full(LOOKS, record.joints.get(joint.name, 0.0)) for joint in arm.joints}
    for drive in (record.signals[name] for name in record.drive):
        seen = drive.values[drive.valid, 0]
        if drive.quantity == "joint_angle" and len(seen):
            rows = np.round(np.linspace(0, 1, LOOKS) * (len(seen) - 1)).astype(int)
            values[str(drive.joint)] = seen[rows]
    return values


def farthest(record: Record, arm: Arm) -> float:
    """How far from the base the points of the rigid arm come [m]; 0 if it has none."""
    places = (rigid_places(record, arm, point.name) for point in arm.points)
    return max((float(np.max(np.linalg.norm(place, axis=1))) for place in places), default=0.0)


def reached(record: Record, arm: Arm) -> float:
    """How far from the base any point can be [m]; what slides, and solid parts, as the record has them."""
    return max(reach(arm), farthest(record, arm))
