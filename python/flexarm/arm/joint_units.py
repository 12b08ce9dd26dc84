"""Units of effects where they act: metres for radians, newtons for newton metres where a joint slides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from flexarm.arm.closure import SLIDING

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.arm.effect import Effect
    from flexarm.arm.prior import Prior

ALONG = {
    "rad": "m",
    "rad/s": "m/s",
    "N m": "N",
    "N m/rad": "N/m",
    "N m/rad3": "N/m3",
    "N m s/rad": "N s/m",
    "m3/rad": "m2",
}
"""Units along a prismatic joint by those about a revolute one."""


def unit_at(effect: Effect, arm: Arm, parameter: str, unit: str) -> str:
    """Return the unit of a parameter of an effect where it acts; phases of waves are angles everywhere."""
    along = not effect.always_turns and _slides(arm, effect.at) and parameter != "phase"
    return ALONG.get(unit, unit) if along else unit


def parameters_in(effect: Effect, arm: Arm) -> list[tuple[str, float, str]]:
    """Parameters of an effect as (name, value, unit), in the units of its place in an arm."""
    return [(name, value, unit_at(effect, arm, name, unit)) for name, value, unit in effect.parameters()]


def priors_in(effect: Effect, arm: Arm) -> dict[str, Prior]:
    """Return what is plausible of an effect, in the units of its place in an arm."""
    return {
        name: replace(prior, unit=unit_at(effect, arm, name, prior.unit))
        for name, prior in effect.priors(arm).items()
    }


def units_by_joint(arm: Arm, joints: Sequence[str], unit: str) -> str:
    """Return the unit of an array by joint: one for all, else one each in their order, with commas."""
    each = [ALONG.get(unit, unit) if _slides(arm, joint) else unit for joint in joints]
    return each[0] if len(set(each)) == 1 else ", ".join(each)


def _slides(arm: Arm, at: str) -> bool:
    """Return True if a place is a joint or closure that slides, or an encoder or torque sensor of one."""
    joint = next((sensor.joint for sensor in arm.sensors if sensor.name == at), at)
    slides = {each.name for each in arm.joints if each.type == "prismatic"}
    return joint in slides | {each.name for each in arm.closures if each.type in SLIDING}
