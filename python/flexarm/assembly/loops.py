"""Joints of closed loops: which of them follow, and where they stand when the loops are closed first.

A loop leaves its joints fewer freedoms than they have. Joints that the caller drives are held; the others
follow. Where the loops could still move, as many more joints are held as it takes, at the pose where the
loops were closed first: those with a drive, then those that slide, then in the order of the model.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from flexarm import _core
from flexarm.arm import Arm, Joint
from flexarm.arm.closure import loop_joints


@dataclass(frozen=True)
class Loops:
    """The loops of an arm."""

    arm: Arm
    system: _core.System
    """Its assembled system, all drives held."""
    assembled: dict[str, float]
    """Joints of loops, and where they stand when the loops are closed first [rad, m]."""
    redundant: int
    """Conditions of closures that others repeat, as in flat loops of rigid links: their forces are taken as
    the smallest."""

    @classmethod
    def of(cls, arm: Arm, system: _core.System) -> Loops:
        """Return the loops of an assembled arm."""
        joints = loop_joints(arm)
        values = zip(arm.joints, system.assembled, strict=True)
        return cls(
            arm,
            system,
            {joint.name: value for joint, value in values if joint.name in joints},
            system.redundant,
        )

    def following(self, driven: Collection[str]) -> tuple[str, ...]:
        """Return the joints of loops that follow when these are driven."""
        names = [joint.name for joint in self.arm.joints]
        rest = [name for name in self.assembled if name not in driven]
        candidates = sorted(rest, key=lambda name: self._rank(self.arm.joint(name)))
        held = [names.index(name) for name in driven if name in names]
        more = self.system.joints_to_hold(held, [names.index(name) for name in candidates])
        return tuple(name for name in rest if names.index(name) not in more)

    def _rank(self, joint: Joint) -> int:
        tables = (*self.arm.motors, *self.arm.controllers)
        if (
            joint.gear_ratio != 1
            or joint.rotor_inertia > 0
            or joint.name in {table.joint for table in tables}
        ):
            return 0
        return 1 if joint.type == "prismatic" else 2
