"""Directions along which the gap of a position is shown.

With one moving joint, about the axis a through o, at the rigid position p of the point for the drive's angle,

    radial   = (p - o) without its part along a, normed                                              (1)
    tangential = a x radial = d p/dq, normed,        normal = a                                      (2)

With several moving joints, or a sliding one, the base's x, y, z. A direction counts as measured if the
measured axes span it to within `span`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from flexarm.arm.kinematics import chain_to, joint_frame, link_pose
from flexarm.arrays import Floats
from flexarm.measurement.frames import Registration
from flexarm.measurement.sampling import columns


def base_directions(count: int) -> dict[str, Floats]:
    """Return x, y, z of the base at `count` instants, each of shape (count, 3)."""
    return {axis: np.broadcast_to(np.eye(3)[i], (count, 3)) for i, axis in enumerate("xyz")}


def joint_directions(
    arm: Any, joint: str, point: str, values: Mapping[str, Floats]
) -> dict[str, Floats] | None:
    """Return tangential, radial and normal (1)-(2) at the point's rigid positions, each of shape (n, 3).

    `values` are drive angles [rad] of the joint, shape (n,), and of joints that stand. None if the joint
    slides, does not carry the point, or the point lies on its axis.
    """
    moving = arm.joint(joint)
    place = arm.point(point)
    if moving.type != "revolute" or moving not in chain_to(arm, place.link):
        return None
    frame = joint_frame(arm, moving, link_pose(arm, moving.parent, values))
    axis = frame.R @ (np.asarray(moving.axis, dtype=float) / np.linalg.norm(moving.axis))
    lever = link_pose(arm, place.link, values).of_point(np.asarray(place.position)) - frame.x
    radial = lever - np.sum(lever * axis, axis=1, keepdims=True) * axis  # eq. (1)
    length = np.linalg.norm(radial, axis=1, keepdims=True)
    if length.min(initial=np.inf) < 1e-9:
        return None
    radial = radial / length
    normal = np.broadcast_to(axis, radial.shape)
    return {"tangential": np.cross(normal, radial), "radial": radial, "normal": normal}  # eq. (2)


def project(
    residual: Floats, axes: Sequence[str] | None, frame: Registration, directions: Mapping[str, Floats]
) -> dict[str, Floats | None]:
    """Project a measured residual, (n, axes) in a frame's axes, on unit vectors, (n, 3), given in the base.

    `axes` names those that were measured; None: all. A direction that they do not span gives None.
    """
    span = 0.02  # greatest part of a direction outside of the measured axes: about one degree
    measured = (frame.error_rotation.T @ frame.frame_axes)[:, columns(axes)]
    found: dict[str, Floats | None] = {}
    for name, unit in directions.items():
        parts = unit @ measured
        outside = np.sqrt(np.maximum(1 - np.sum(parts**2, axis=1), 0.0))
        found[name] = np.sum(parts * residual, axis=1) if outside.max(initial=0.0) < span else None
    return found
