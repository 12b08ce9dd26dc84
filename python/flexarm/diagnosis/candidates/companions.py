"""Joints that are one thing of the machine though the model has two: the axes of a cardan joint.

A guide, a mount or a bearing gives way about two axes at one place. A tree of joints with one axis each says
so with two joints whose axes meet in a point, a link without mass between them, and nothing that drives
either. If such a place is soft it is soft about both axes, each with its own stiffness: a law at the first
without the same law at the second is no likelier a cause than both, so both are tried as one.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from flexarm.arm import Arm
from flexarm.arm.link import RigidLink

if TYPE_CHECKING:
    from flexarm.diagnosis.candidates.candidate import Candidate
    from flexarm.record import Record


def cardan_joints(arm: Arm, driven: Iterable[str]) -> dict[str, str]:
    """Second joint of each cardan joint, by the first.

    Parameters
    ----------
    arm : Arm
        The model.
    driven : iterable of str
        Joints that something turns.
    """
    idle = {joint.name for joint in arm.joints if joint.type == "revolute"} - set(driven)
    found = {}
    for first in arm.joints:
        for second in arm.joints:
            if (
                {first.name, second.name} <= idle
                and second.parent == first.child
                and not any(second.origin.xyz)
                and _weightless(arm, first.child)
            ):
                found[first.name] = second.name
    return found


def driven_joints(arm: Arm, records: Iterable[Record]) -> set[str]:
    """Joints that a drive turns in some record, or that a gear couples to one of them."""
    found = {record.signals[name].joint for record in records for name in record.drive}
    for _ in arm.gears:  # trains of gears
        for gear in arm.gears:
            if found & {gear.input, gear.output}:
                found |= {gear.input, gear.output}
    return {name for name in found if name is not None}


def causes(members: Sequence[Candidate], pairs: dict[str, str]) -> int:
    """Number of effects, the same one at both axes of a cardan joint counted once."""
    places = {member.place for member in members}
    return len(members) - sum((m.name, pairs.get(m.at, "")) in places for m in members)


def _weightless(arm: Arm, name: str) -> bool:
    link = arm.link(name)
    return isinstance(link, RigidLink) and link.mass == 0
