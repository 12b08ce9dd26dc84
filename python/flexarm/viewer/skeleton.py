"""Where an arm is drawn from: its bones, frames on links that follow the deformed arm.

A beam has bones along its centre line, a rigid link its own frame, a super-element those of its interfaces.
Bones are points of the model, added to it, so whatever computes points, with rotations, moves the bones:

    x_i(s) = x_i,rigid + s (x_i - x_i,rigid),     R_i(s) = exp(s log(R_i R_i,rigid^T)) R_i,rigid      (1)

with s the scale of the deformation, and the rigid arm at the same drive angles.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from flexarm.arm import Arm, Beam
from flexarm.arm.attachment import Point
from flexarm.arm.kinematics import link_pose
from flexarm.arm.link import Link
from flexarm.arm.names import link_of
from flexarm.arm.rotation import added
from flexarm.arrays import Floats
from flexarm.assembly import machine_of, rigid_values

FEWEST, MOST = 8, 32
"""Pieces in which a beam is drawn: two an element within these bounds look smooth."""


@dataclass(frozen=True)
class Poses:
    """Frames over time: rotations (m, bone, 3, 3) and positions (m, bone, 3) [m], base axes."""

    R: Floats
    x: Floats

    def __getitem__(self, chosen: Any) -> Poses:
        return Poses(self.R[chosen], self.x[chosen])

    def scaled(self, rigid: Poses, scale: float) -> Poses:
        """Return these poses with deformations times `scale`, eq. (1)."""
        if scale == 1:
            return self
        from scipy.spatial.transform import Rotation

        away = Rotation.from_matrix((self.R @ np.swapaxes(rigid.R, -1, -2)).reshape(-1, 3, 3))
        turn = scale * np.asarray(away.as_rotvec()).reshape(self.x.shape)
        return Poses(_turned(turn) @ rigid.R, rigid.x + scale * (self.x - rigid.x))

    def moved(self, shift: Floats, turn: Floats) -> Poses:
        """Return these poses moved by shifts (..., bone, 3) [m] and rotation vectors [rad], base axes."""
        return Poses(_turned(turn) @ self.R, self.x + shift)


@dataclass(frozen=True)
class Bone:
    """A frame on a link: the place that a point names, and where in it [m]."""

    link: str
    position: tuple[float, float, float]


class Skeleton:
    """The bones of an arm in the order of poses, and the arm with a point at each of them, behind its own.

    `along` has the bones of each link: along a beam, at the interfaces of a super-element, the frame of a
    rigid link. `loads` and `points` are bones of payloads, at their centres, and of points.
    """

    def __init__(self, arm: Arm) -> None:
        self.arm = arm
        self.along: dict[str, list[int]] = {}
        found: list[Bone] = []
        for link in arm.links:
            places = _places(link)
            self.along[link.name] = list(range(len(found), len(found) + len(places)))
            found += places
        own = [effect for effect in arm.effects if effect.place in ("payload", "point")]
        machine = machine_of(arm.replace(effects=own))  # those of links move the bones, as they do points
        self.loads = {name: len(found) + i for i, name in enumerate(machine.payloads)}
        found += [Bone(load.link, added(load.position, load.offset)) for load in machine.payloads.values()]
        self.points = {name: len(found) + i for i, name in enumerate(machine.points)}
        found += [Bone(place.link, place.position) for place in machine.points.values()]
        self.bones = tuple(found)

    @cached_property
    def seen(self) -> Arm:
        """The arm with a point at each bone, the last of its points. Effects of points stay with its own."""
        taken = {point.name for point in self.arm.points}
        prefix = "bone"
        while any(name.startswith(prefix) for name in taken):
            prefix += "_"
        marks = [
            Point(name=f"{prefix}{i}", link=bone.link, position=bone.position)
            for i, bone in enumerate(self.bones)
        ]
        return self.arm.replace(points=(*self.arm.points, *marks))

    @property
    def chosen(self) -> slice:
        """The bones among the points of `seen`."""
        return slice(len(self.arm.points), None)

    def rigid(self, angles: Floats) -> Poses:
        """Return the bones of the rigid arm without effects, at drive angles (m, joint)."""
        values = {joint.name: angles[:, i] for i, joint in enumerate(self.arm.joints)}
        places = {bone.link: link_pose(self.arm, bone.link, values) for bone in self.bones}
        shape = (len(angles), 3, 3)
        R = [np.broadcast_to(places[bone.link].R, shape) for bone in self.bones]
        x = [
            np.broadcast_to(places[bone.link].of_point(np.asarray(bone.position)), shape[:2])
            for bone in self.bones
        ]
        return Poses(np.stack(R, axis=1), np.stack(x, axis=1))

    def bone_of(self, place: str, at_end: bool = False) -> int:
        """Return the bone of a place that a joint names; -1 for the base."""
        link = link_of(place)
        if link == "base":
            return -1
        interface = place.partition(":")[2]
        bones = self.along[link]
        if interface:
            return next(i for i in bones if self.bones[i].link == place)
        return bones[-1] if at_end else bones[0]


def quaternions(poses: Poses) -> Floats:
    """Return x, y, z, w of every pose, shape (m, bone, 4)."""
    from scipy.spatial.transform import Rotation

    found = Rotation.from_matrix(poses.R.reshape(-1, 3, 3)).as_quat()
    return np.asarray(found).reshape(*poses.x.shape[:-1], 4)


def from_quaternions(x: Floats, quaternion: Floats) -> Poses:
    """Return poses of positions (m, bone, 3) and quaternions (m, bone, 4)."""
    from scipy.spatial.transform import Rotation

    R = Rotation.from_quat(quaternion.reshape(-1, 4)).as_matrix()
    return Poses(R.reshape(*x.shape[:-1], 3, 3), x)


def _turned(vectors: Floats) -> Floats:
    """Return the rotations of vectors (..., 3) [rad], shape (..., 3, 3)."""
    from scipy.spatial.transform import Rotation

    R = Rotation.from_rotvec(np.array(vectors).reshape(-1, 3)).as_matrix()
    return np.asarray(R).reshape(*vectors.shape, 3)


def _places(link: Link) -> list[Bone]:
    if isinstance(link, Beam):
        n = min(max(2 * link.elements, FEWEST), MOST)
        return [Bone(link.name, tuple(map(float, np.array(link.end) * i / n))) for i in range(n + 1)]  # type: ignore[arg-type]
    if link.type == "superelement":
        return [Bone(f"{link.name}:{name}", (0.0, 0.0, 0.0)) for name in link.part.interfaces]
    return [Bone(link.name, (0.0, 0.0, 0.0))]


def at_rest(arm: Arm, joints: Mapping[str, float]) -> Floats:
    """Return drive angles (1, joint) of a pose, those of loops closed."""
    return np.array([rigid_values(arm, joints)])
