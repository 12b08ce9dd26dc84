"""Gears: joints that move together, and total ratios from a motor's shaft."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.arm.joint import Gear


def coupled_joints(joints: Iterable[str], gears: Sequence[Gear]) -> set[str]:
    """Return these joints and all that gears couple to them."""
    found = set(joints)
    for _ in gears:  # a chain has no more of them
        for gear in gears:
            if found & {gear.input, gear.output}:
                found |= {gear.input, gear.output}
    return found


def shaft_ratio(joint: str | None, gears: Sequence[Gear]) -> float:
    """Return the turns of a joint for one turn of the slowest joint that it drives; 1 if it drives none."""
    found = 1.0
    for k, gear in enumerate(gears):
        if gear.input == joint:
            others = [*gears[:k], *gears[k + 1 :]]
            found = max(found, abs(gear.ratio) * shaft_ratio(gear.output, others))
    return found


def gear_input(arm: Arm, joint: str) -> str:
    """Return the joint whose drive moves a joint: itself, or at the input of its gears."""
    inputs = {gear.output: gear.input for gear in arm.gears}
    while joint in inputs:
        joint = inputs[joint]
    return joint
