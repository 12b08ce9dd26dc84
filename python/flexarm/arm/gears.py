"""What gears couple: joints that move together, and how often a motor's shaft turns for what it drives."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flexarm.arm.joint import Gear


def coupled_joints(joints: Iterable[str], gears: Sequence[Gear]) -> set[str]:
    """These joints and all that gears move along with them."""
    found = set(joints)
    for _ in gears:  # a chain has no more of them
        for gear in gears:
            if found & {gear.input, gear.output}:
                found |= {gear.input, gear.output}
    return found


def shaft_ratio(joint: str | None, gears: Sequence[Gear]) -> float:
    """Turns of a joint for one of the slowest that it drives by gears; 1 of a joint that drives none."""
    found = 1.0
    for k, gear in enumerate(gears):
        if gear.input == joint:
            others = [*gears[:k], *gears[k + 1 :]]
            found = max(found, abs(gear.ratio) * shaft_ratio(gear.output, others))
    return found
