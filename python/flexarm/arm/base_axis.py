"""The axis about which a compliant base turns: of the first joint that turns, through the base's origin."""

from __future__ import annotations

from flexarm.arm.arm import Arm
from flexarm.arm.joint import Joint
from flexarm.arm.names import from_base, link_of
from flexarm.arm.places import place_in_link
from flexarm.arm.rotation import Vector, chained, rotated


def first_turning_joint(arm: Arm) -> Joint | None:
    """Return the revolute joint nearest to the base, the first in the file if several; None if none."""
    return next((joint for joint in from_base(arm.joints) if joint.type == "revolute"), None)


def base_axis(arm: Arm) -> Vector:
    """Return the axis of that joint at q = 0 in base axes; its length is arbitrary."""
    from flexarm.arm.weight import link_frames

    joint = first_turning_joint(arm)
    if joint is None:
        return (0.0, 0.0, 1.0)
    child = link_frames(arm)[link_of(joint.child)]
    rotation, _ = chained(child, place_in_link(arm, joint.child))  # turning about the axis leaves it
    return rotated(rotation, joint.axis)
