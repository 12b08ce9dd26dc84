"""Equilibria and modes of a study."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.consistency import missing
from flexarm.arrays import Floats
from flexarm.campaigns.outcome import Outcome, Prepared, Runner, Value, Variable
from flexarm.campaigns.study import Found, Keep, Study
from flexarm.modal import modes
from flexarm.statics.static import static

_STATIC = {
    "position": ("point", "m", "m"),
    "displacement": ("point", "m", "m"),
    "joint_torque": ("joint", "N m", "N"),
    "link_angle": ("joint", "rad", "m"),
}
"""Arrays of an equilibrium: kind of place, unit, and unit of a prismatic joint."""
_MODES = {"frequency_hz": "Hz", "damping_ratio": "-"}


@dataclass
class StaticRun(Runner):
    """Equilibria with drives held."""

    joints: Mapping[str, float]
    keep: tuple[Keep, ...]
    variables: tuple[Variable, ...]

    def outcome(self, arm: Arm, case: int) -> Outcome:
        """Return what is kept of one equilibrium."""
        held = static(arm, joints=self.joints)
        found: dict[str, Value] = {}
        for keep in self.keep:
            array = getattr(held, keep.quantity)
            if keep.point is not None:
                array = array[held.points.index(keep.point)][
                    ["xyz".index(axis) for axis in keep.axes or "xyz"]
                ]
            else:
                array = array[held.joints.index(keep.joint or "")]
            array = np.asarray(array)
            found[keep.variable] = float(array.item()) if array.size == 1 else array
        return found


@dataclass
class ModesRun(Runner):
    """Natural frequencies and damping about the equilibrium."""

    joints: Mapping[str, float]
    count: int
    variables: tuple[Variable, ...]

    def outcome(self, arm: Arm, case: int) -> Outcome:
        """Return what is kept of one arm's modes; NaN for modes that it has not."""
        found = modes(arm, joints=self.joints, count=self.count)
        return {each.name: _filled(getattr(found, each.text), self.count) for each in self.variables}


def _filled(values: Floats, count: int) -> Floats:
    found = np.full(count, np.nan)
    found[: len(values)] = values[:count]
    return found


def static_run(study: Study, arm: Arm) -> Prepared:
    """Return equilibria of a study, and what is wrong with what is to be kept."""
    found: Found = _joint_problems(study, arm)
    variables = []
    for i, keep in enumerate(study.keep):
        if keep.quantity not in _STATIC:
            allowed = ", ".join(_STATIC)
            found.append((("keep", i, "quantity"), f"must be one of {allowed}, got {keep.quantity!r}"))
            continue
        kind, unit, along = _STATIC[keep.quantity]
        name = getattr(keep, kind)
        names = [each.name for each in getattr(arm, f"{kind}s")]
        if name is None:
            found.append((("keep", i, kind), f"is missing; {keep.quantity} needs the name of a {kind}"))
            continue
        if name not in names:
            found.append((("keep", i, kind), missing(kind, name, names)))
            continue
        slides = kind == "joint" and arm.joint(name).type == "prismatic"
        axes = keep.axes or ("x", "y", "z")
        vector = kind == "point" and len(axes) > 1
        axis = "axis" if axes == ("x", "y", "z") else f"{keep.variable}_axis"
        variables.append(
            Variable(
                keep.variable,
                along if slides else unit,
                f"{keep.quantity} at {name}",
                (axis,) if vector else (),
                {axis: list(axes)} if vector else {},
                tolerance=keep.tolerance,
            )
        )
    return StaticRun(study.joints, study.keep, tuple(variables)), found


def modes_run(study: Study, arm: Arm) -> Prepared:
    """Return modes of a study, and what is wrong with what is to be kept; without `keep` all is."""
    found: Found = _joint_problems(study, arm)
    kept = study.keep or tuple(Keep(quantity=quantity) for quantity in _MODES)
    numbers = np.arange(1, study.count + 1)
    variables = []
    for i, keep in enumerate(kept):
        if keep.quantity not in _MODES:
            allowed = " or ".join(_MODES)
            found.append((("keep", i, "quantity"), f"must be {allowed}, got {keep.quantity!r}"))
            continue
        if keep.place:
            kind = "joint" if keep.joint else "point" if keep.point else "link"
            what = f"does not belong to {keep.quantity}, which is of the whole arm"
            found.append((("keep", i, kind), what))
        variables.append(
            Variable(
                keep.variable,
                _MODES[keep.quantity],
                keep.quantity,
                ("mode",),
                {"mode": numbers},
                tolerance=keep.tolerance,
            )
        )
    return ModesRun(study.joints, study.count, tuple(variables)), found


def _joint_problems(study: Study, arm: Arm) -> Found:
    moving = [joint.name for joint in arm.moving_joints]
    return [
        (("joints", name), missing("moving joint", name, moving))
        for name in study.joints
        if name not in moving
    ]
