"""Inputs of joints, and the numbers that the core takes of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite, nan

import numpy as np

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.consistency import missing
from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter

Input = float | Sequence[float]

_KINDS = {
    "motor": _core.DriveKind.motor_angle,
    "output": _core.DriveKind.link_angle,
    "torque": _core.DriveKind.torque,
    "free": _core.DriveKind.free,
}


class Inputs:
    """Turns what the user tells joints by name, as `Stepper` takes it, into rows for the core.

    Raise InvalidParameter if a joint does not exist or cannot be told that.
    """

    def __init__(self, arm: Arm, told: Mapping[str, str]) -> None:
        self._arm = arm
        self.told = dict(told)
        self._joints = {joint.name: i for i, joint in enumerate(arm.joints)}
        self._check_told()
        self._places = {name: self._place(name) for name, what in self.told.items() if what != "free"}

    def rows(self, inputs: Mapping[str, Input]) -> Floats:
        """Value, rate and acceleration of every joint; NaN for rates that follow from the angles."""
        rows = np.zeros((len(self._joints), 3))
        rows[:, 1:] = nan
        if not isinstance(inputs, Mapping):
            raise InvalidParameter(f"must be a dictionary, got {type(inputs).__name__}", where="inputs")
        if inputs.keys() != self._places.keys():
            wrong = sorted(map(str, inputs.keys() ^ self._places.keys()))
            raise InvalidParameter(
                f"must be given for exactly {', '.join(self._places) or 'no joint'}; "
                f"missing or unknown: {', '.join(wrong)}",
                where="inputs",
            )
        for name, value in inputs.items():
            row, factor, is_angle = self._places[name]
            if isinstance(value, float) and isfinite(value):
                rows[row, 0] = factor * value
            else:
                rows[row] = _checked(name, value, is_angle)
                rows[row] *= factor
        return rows

    def words(self, inputs: Mapping[str, Input]) -> str:
        """Return inputs as text, with their units."""
        sliding = {joint.name for joint in self._arm.moving_joints if joint.type == "prismatic"}
        units = {True: ("N", "m"), False: ("N m", "rad")}
        return ", ".join(
            f"{name} = {np.ravel(value)[0]:.4g} {units[name in sliding][self._places[name][2]]}"
            for name, value in inputs.items()
        )

    def _check_told(self) -> None:
        moving = [joint.name for joint in self._arm.moving_joints]
        for name, what in self.told.items():
            if name not in moving:
                raise InvalidParameter(missing("moving joint", name, moving), where="inputs")
            if what not in _KINDS:
                raise InvalidParameter(
                    f"must be one of {', '.join(_KINDS)}, got {what!r}", where=f"inputs.{name}"
                )

    def _place(self, name: str) -> tuple[int, float, bool]:
        """Row of a joint's input and the factor to it, through gears to the motor; whether it is an angle."""
        factor = 1.0
        if self.told[name] == "motor":
            drivers = {gear.output: gear for gear in self._arm.gears if gear.input not in self.told}
            while name in drivers:
                factor *= drivers[name].ratio
                name = drivers[name].input
        return self._joints[name], factor, self.told.get(name, "motor") != "torque"

    def kinds(self, held: bool = False) -> dict[str, _core.DriveKind]:
        """Return the kind of drive of each joint; a motor's angle acts at the input of its gears.

        As long as `held`, joints that are told a torque or nothing are held.
        """
        names = list(self._joints)
        found = {}
        for name, what in self.told.items():
            moved = names[self._places[name][0]] if what == "motor" else name
            found[moved] = _KINDS["motor" if held and what != "output" else what]
        return found


def _checked(name: str, value: Input, is_angle: bool) -> Floats:
    """Return a number that is no float, or an angle with rate and acceleration, as a row.

    Raise InvalidParameter if it is neither, or not finite.
    """
    allowed = "a finite number" + (
        " or (angle, rate, acceleration)" if is_angle else " [N m, N if prismatic]"
    )
    try:
        row = np.array(value, dtype=float)
    except (TypeError, ValueError):
        row = np.array(nan)
    if row.shape == () and np.isfinite(row):
        return np.array([float(row), nan, nan])
    if is_angle and row.shape == (3,) and np.isfinite(row).all():
        return row
    raise InvalidParameter(f"must be {allowed}, got {value!r}", where=f"inputs.{name}")
