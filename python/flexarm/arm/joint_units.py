"""Units and plausible sizes of effects where a joint slides: metres for radians, newtons for newton metres.

Priors are stated for joints that turn. A joint that slides has those of one that turns a pinion of radius r:
with the angle x/r and the torque F r a stiffness is 1/r^2 times that of the pinion, a clearance r times.
"""

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
PINION = 0.1
"""Radius r of the pinion [m]: rates at bearings are stated at radii of some 0.1 m, too."""
POWERS = {"rad": 1, "rad/s": 1, "N m": -1, "N m/rad": -2, "N m/rad3": -4, "N m s/rad": -2}
"""Powers of r by which a quantity about a revolute joint becomes that along a prismatic one."""


def unit_at(effect: Effect, arm: Arm, parameter: str, unit: str) -> str:
    """Return the unit of a parameter of an effect where it acts; phases of waves are angles everywhere."""
    straight = not effect.always_turns and slides(arm, effect.at) and parameter != "phase"
    return ALONG.get(unit, unit) if straight else unit


def parameters_in(effect: Effect, arm: Arm) -> list[tuple[str, float, str]]:
    """Parameters of an effect as (name, value, unit), in the units of its place in an arm."""
    return [(name, value, unit_at(effect, arm, name, unit)) for name, value, unit in effect.parameters()]


def along(effect: Effect, arm: Arm, parameter: str, unit: str) -> float:
    """Return the factor that makes a plausible number about a joint one where the effect acts in an arm."""
    straight = not effect.priors_along and unit_at(effect, arm, parameter, unit) != unit
    return PINION ** POWERS.get(unit, 0) if straight else 1.0


def priors_in(effect: Effect, arm: Arm) -> dict[str, Prior]:
    """Return what is plausible of an effect, in the units of its place in an arm."""
    found = {}
    for name, prior in _on_pinion(effect, arm).priors(_with_pinion(arm, effect.at)).items():
        times, unit = along(effect, arm, name, prior.unit), unit_at(effect, arm, name, prior.unit)
        low, typical, high = (times * value for value in (prior.low, prior.typical, prior.high))
        found[name] = replace(prior, low=low, typical=typical, high=high, unit=unit)
    return found


def _on_pinion(effect: Effect, arm: Arm) -> Effect:
    """Return an effect with the numbers that it has about a pinion, if its joint slides."""
    changed = {
        name: value / times
        for name, value, unit in effect.parameters()
        if name in type(effect).model_fields and (times := along(effect, arm, name, unit)) != 1.0
    }
    return effect.model_copy(update=changed) if changed else effect


def _with_pinion(arm: Arm, at: str) -> Arm:
    """Return as much of an arm as priors ask for, in which a joint that slides turns a pinion."""
    if not any(joint.name == at and joint.type == "prismatic" for joint in arm.joints):
        return arm
    joints = [
        joint.replace(type="revolute", gear_ratio=PINION * joint.gear_ratio) if joint.name == at else joint
        for joint in arm.joints
    ]
    effects = [_on_pinion(effect, arm) for effect in arm.effects_at(at)]
    rest: dict[str, object] = dict.fromkeys(("sensors", "controllers", "gears", "closures"), ())
    return arm.replace(joints=tuple(joints), effects=tuple(effects), uncertainty={}, assembly={}, **rest)


def units_by_joint(arm: Arm, joints: Sequence[str], unit: str) -> str:
    """Return the unit of an array by joint: one for all, else one each in their order, with commas."""
    each = [ALONG.get(unit, unit) if slides(arm, joint) else unit for joint in joints]
    return each[0] if len(set(each)) == 1 else ", ".join(each)


def slides(arm: Arm, at: str) -> bool:
    """Return True if a place is a joint or closure that slides, or an encoder or torque sensor of one."""
    joint = joint_of_signal(arm, at) or at
    sliding = {each.name for each in arm.joints if each.type == "prismatic"}
    return joint in sliding | {each.name for each in arm.closures if each.type in SLIDING}


def joint_of_signal(arm: Arm, name: str) -> str | None:
    """Return the joint of a signal, as far as the model says it."""
    sensors = {sensor.name: sensor.joint for sensor in arm.sensors}
    return sensors.get(name, arm.encoders.get(name))
