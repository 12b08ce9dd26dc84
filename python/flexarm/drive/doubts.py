"""Plausibility of drives: degrees, angles of motors, strokes, milliseconds, controllers at rest."""

from __future__ import annotations

from collections.abc import Iterable
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm.joint import shaft_ratio
from flexarm.errors import Problem
from flexarm.record.time_unit import implausible_duration, motion_of, span_of

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.drive.drive import Drive

MOST = 4 * pi
"""Angle that hardly any joint reaches at its output [rad]."""
REMEDY = "write them in s"


def doubts(drive: Drive, arm: Arm) -> Iterable[Problem]:
    """Yield joints that turn several times or leave their stroke, idle controllers, and runs of hours."""
    controlled = {controller.joint for controller in arm.controllers}
    for name, joint in drive.joints.items():
        most = float(np.max(np.abs(joint(joint.breaks)))) / shaft_ratio(name, arm.gears)
        if arm.joint(name).type == "revolute" and most > MOST:
            turns = f"{most / (2 * pi):.1f} turns"
            doubt = "is it in degrees, or not yet divided by the ratio?"
            yield Problem(f"column {name}", f"reaches {most:g} rad, {turns}; {doubt}")
        values = joint(joint.breaks)
        if what := beyond_travel(arm, name, float(np.min(values)), float(np.max(values))):
            yield Problem(f"column {name}", what)
        if name in controlled and joint.side == "motor":
            what = "moves the motor itself, so its controller does not act; a record with a joint_command as "
            yield Problem(f"column {name}", f"{what}drive lets it")
    motions = [
        motion_of(name, joint.breaks, joint(joint.breaks), "m" if slides(arm, name) else "rad")
        for name, joint in drive.joints.items()
    ]
    span = next((span_of(joint.breaks) for joint in drive.joints.values()), None)
    if span is not None:
        yield from (Problem("column time_s", what) for what in implausible_duration(span, motions, REMEDY))


def beyond_travel(arm: Arm, joint: str, lowest: float, highest: float) -> str:
    """Return how far a drive leaves the travel of an effect at its joint; empty if it stays within."""
    for effect in arm.effects:
        low, high = effect.travel
        if effect.at == joint and not low <= lowest <= highest <= high:
            unit = "m" if slides(arm, joint) else "rad"
            far = lowest if lowest < low else highest
            return f"reaches {far:g} {unit}; its {effect.name} travels from {low:g} to {high:g} {unit}"
    return ""


def slides(arm: Arm, joint: str) -> bool:
    """Return True for a prismatic joint."""
    return arm.joint(joint).type == "prismatic"
