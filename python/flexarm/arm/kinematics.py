"""Forward kinematics of a rigid arm: poses of its links by multiplication along the chain from the base.

    H_child = H_parent T_at T_origin exp(axis q) T_in^-1                                             (1)

T_at goes to the far end of a beam (`at = "end"`) or to the interface of a super-element that the joint
names, T_origin is the joint's `origin`, exp the turn (revolute) or shift (prismatic) by q about the joint's
axis, and T_in leads from the child's frame to its interface. All joint values may be arrays over time.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexarm.arm.closure import loop_joints
from flexarm.arm.names import link_of
from flexarm.arm.places import place_in_link
from flexarm.arm.rotation import IDENTITY, from_rpy, inverted
from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter


@dataclass(frozen=True)
class Pose:
    """Rotations and positions over time, in the base: R (m, 3, 3), x (m, 3) [m]."""

    R: Floats
    x: Floats

    def moved(self, rotation: Floats, translation: Floats) -> Pose:
        """Return this pose times a pose in its own axes."""
        turned = self.R if np.array_equal(rotation, IDENTITY) else self.R @ rotation
        return Pose(turned, self.x + self.R @ translation if np.any(translation) else self.x)

    def of_point(self, position: Floats) -> Floats:
        """Return the positions in the base of a point given in this frame, shape (m, 3)."""
        return self.x + self.R @ position


def joint_to(arm: Any, link: str) -> Any:
    """Return the joint whose child is the link, or an interface of it; None for the base."""
    return next((joint for joint in arm.joints if link_of(joint.child) == link), None)


def chain_to(arm: Any, place: str) -> list[Any]:
    """Return the joints from the base to a link, or to the link of an interface.

    Raise InvalidParameter if no joint leads there.
    """
    found: list[Any] = []
    link = link_of(place)
    while link != "base":
        joint = joint_to(arm, link)
        if joint is None:
            raise InvalidParameter(f"no joint leads to the link {link!r}")
        found.insert(0, joint)
        link = link_of(joint.parent)
    return found


def carrying_joint(arm: Any, place: str) -> Any:
    """Return the moving joint that carries a link, a payload or what a joint carries.

    Of the base, and where none carries it, the first that moves; None if none moves.
    """
    links = {each.name: each.name for each in arm.links}
    links |= {joint.name: joint.child for joint in arm.joints}
    links |= {load.name: load.link for load in arm.payloads}
    moving = list(arm.moving_joints)
    before = [each for each in chain_to(arm, links[place]) if each in moving] if place in links else []
    return next(reversed(before), next(iter(moving), None))


def joint_frame(arm: Any, joint: Any, parent: Pose) -> Pose:
    """Return the frame in which a joint turns, before it turns, in the pose of the place `joint.parent`."""
    if joint.at == "end":
        parent = parent.moved(np.eye(3), np.asarray(arm.link(joint.parent).end))
    return parent.moved(np.array(from_rpy(joint.origin.rpy)), np.asarray(joint.origin.xyz))


def link_pose(arm: Any, link: str, values: Mapping[str, Floats], base: Any = IDENTITY) -> Pose:
    """Return the pose (1) of a link of the rigid arm, "base", or LINK:INTERFACE on a super-element.

    `values` are those of the joints on the way [rad or m], shape (m,), by default 0; `base` is the rotation,
    (3, 3), of everything that stands on the base.
    """
    joints = chain_to(arm, link)
    if arm.closures and (left_out := set(loop_joints(arm)) & {j.name for j in joints} - set(values)):
        raise InvalidParameter(
            f"joints of closed loops follow one another: values of all are needed, {min(left_out)} has none",
            where="joints",
        )
    count = max((np.size(values.get(joint.name, 0.0)) for joint in joints), default=1)
    pose = Pose(np.reshape(base, (-1, 3, 3)), np.zeros((1, 3)))  # one until a joint has many values
    for joint in joints:
        pose = _moved_by(
            joint_frame(arm, joint, _at(pose, place_in_link(arm, joint.parent))),
            joint,
            np.asarray(values.get(joint.name, 0.0), dtype=float),
        )
        pose = _at(pose, inverted(*place_in_link(arm, joint.child)))
    pose = _at(pose, place_in_link(arm, link))
    return Pose(np.broadcast_to(pose.R, (count, 3, 3)), np.broadcast_to(pose.x, (count, 3)))


def point_jacobian(arm: Any, joint: str, point: str, values: Mapping[str, Floats]) -> Floats:
    """Return the derivative of a point with respect to the value of a joint, base axes, shape (m, 3).

        dp/dq = a x (p - o)   revolute,      dp/dq = a   prismatic                                   (2)

    with the axis a through o; zero if the joint does not carry the point. In m/rad or m/m.
    """
    moving, place = arm.joint(joint), arm.point(point)
    position = link_pose(arm, place.link, values).of_point(np.asarray(place.position))
    if not moving.moves or moving not in chain_to(arm, place.link):
        return np.zeros_like(position)
    frame = joint_frame(arm, moving, link_pose(arm, moving.parent, values))
    axis = frame.R @ (np.asarray(moving.axis, dtype=float) / np.linalg.norm(moving.axis))
    axis = np.broadcast_to(axis, position.shape)
    return np.array(axis) if moving.type == "prismatic" else np.cross(axis, position - frame.x)  # eq. (2)


def _at(pose: Pose, frame: Any) -> Pose:
    rotation, position = frame
    return pose.moved(np.asarray(rotation), np.asarray(position))


def _moved_by(pose: Pose, joint: Any, value: Floats) -> Pose:
    """Return the child's pose: exp(axis q) of (1)."""
    if joint.type == "fixed":
        return pose
    axis = np.asarray(joint.axis, dtype=float)
    axis = axis / np.linalg.norm(axis)
    q = np.atleast_1d(value)
    if joint.type == "prismatic":
        return Pose(pose.R, pose.x + q[:, None] * (pose.R @ axis))
    return Pose(pose.R @ turns(axis, q), pose.x)


def turns(axis: Floats, angle: Floats) -> Floats:
    """Return rotations by `angle` [rad] about a unit axis, shape (m, 3, 3)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    found: Floats = (
        np.eye(3)
        + np.sin(angle)[:, None, None] * cross
        + (1 - np.cos(angle))[:, None, None] * (cross @ cross)
    )
    return found
