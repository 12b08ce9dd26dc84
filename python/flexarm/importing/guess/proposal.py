"""A proposed signal of a map, with the reason for each of its keys."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import pi
from typing import Any

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.joint import motor_ratio
from flexarm.drive.doubts import slides
from flexarm.importing.guess.logged import Logged
from flexarm.importing.guess.motion import Track
from flexarm.importing.guess.words import COUNTED
from flexarm.quantities import QUANTITIES
from flexarm.units import factor_to

TURNS = 2.0
"""Turns that a joint's output may make, where no measured point tells."""
FARTHEST_SLIDE = 10.0
"""How far a joint may slide there [m]."""


Option = tuple[str | int, bool]
"""Unit of an angle, or the counts of a turn; and True if it is before the gear."""


@dataclass(eq=False)
class Proposal:
    """A signal of the map, and why."""

    columns: list[Logged]
    quantity: str
    place: tuple[str, str]
    """Kind and name of the place; empty name: unknown."""
    name: str = ""
    keys: dict[str, Any] = field(default_factory=dict)
    """Further keys of the map."""
    why: dict[str, str] = field(default_factory=dict)
    unknown: dict[str, str] = field(default_factory=dict)
    """By key the reason, and what is not known."""
    rivals: tuple[Option, ...] = ()
    """Other units with which the model moves about as far as measured."""
    own_clock: bool = False
    """True if its stamps are late against those of the joints in the same file."""
    out: bool = False
    """True if it is commented out, as the map could not be read with it."""

    @property
    def first(self) -> Logged:
        """The first column."""
        return self.columns[0]

    def track(self) -> Track:
        """Return its values in SI, by the keys so far."""
        factor = self.factor()
        time = self.first.time
        return Track.of(time.seconds, [factor * column.values for column in self.columns], time.poses)

    def raw(self, arm: Arm) -> Track:
        """Return an angle as the smallest of what it may be: in degrees where it is too far for radians.

        The way of a joint that slides is in millimetres where it is too far for metres.
        """
        values = self.first.values
        reach = float(np.nanmax(np.abs(values)))
        if slides(arm, self.place[1]):
            return in_output(self, arm, (self.first.meaning.unit or _unit_of_way(reach), False))
        unit = self.first.meaning.unit or ("rad" if reach <= pi * TURNS else "deg")
        geared = np.radians(reach) if unit == "deg" else reach
        option = (unit, self.keys.get("side") == "motor" and geared > pi * TURNS)
        return in_output(self, arm, option)

    def moves(self) -> bool:
        """Return True if a value changes."""
        return any(np.nanmax(c.values) > np.nanmin(c.values) for c in self.columns)

    def factor(self) -> float:
        """Return the factor to SI of its unit."""
        units = ("rad",) if "rotation" in self.keys else QUANTITIES[self.quantity].units
        return unit_factor(self.keys.get("unit", units[0]), units) if units else 1.0

    def take(self, option: Option) -> None:
        """Give its unit, and whether it is before the gear."""
        for values in (self.keys, self.why):
            values.pop("before_gear", None)
            values.pop("unit", None)
        self.keys["unit"], geared = option
        if self.first.meaning.unit:
            self.why["unit"] = "the log says it"
        if geared:
            self.keys["before_gear"] = True

    @property
    def counts(self) -> bool:
        """True for the counts of an encoder."""
        return self.first.meaning.unit == COUNTED


def unit_factor(unit: Any, units: Sequence[str]) -> float:
    """Return the factor to SI of a unit by name, or of counts per turn; 1 if none fits."""
    counts = unit.get("counts_per_turn") if isinstance(unit, Mapping) else unit
    if isinstance(counts, int):
        return 2 * pi / counts if counts else 1.0
    return next((f for si in units if (f := factor_to(si, str(unit))) is not None), 1.0)


def in_output(proposal: Proposal, arm: Arm, option: Option | None = None) -> Track:
    """Return an angle at the output [rad or m], by its keys or as another option."""
    own = "m" if slides(arm, proposal.place[1]) else "rad"
    unit, geared = option or (proposal.keys.get("unit", own), proposal.keys.get("before_gear", False))
    factor = unit_factor(unit, QUANTITIES[proposal.quantity].units) * proposal.keys.get("scale", 1.0)
    ratio = motor_ratio(arm, proposal.place[1]) if geared else 1.0
    time = proposal.first.time
    return Track.of(time.seconds, [proposal.first.values * factor / ratio], time.poses)


def _unit_of_way(reach: float) -> str:
    return "m" if reach <= FARTHEST_SLIDE else "mm"


def words_of(option: Option) -> str:
    """Return an option in words."""
    unit = f"{option[0]} counts a turn" if isinstance(option[0], int) else option[0]
    return f"{unit} {'before the gear' if option[1] else 'of the output'}"


def drives_of(proposals: Sequence[Proposal]) -> list[Proposal]:
    """Return the signals that drive: of each joint a motor's angle, else another one, else a command."""
    found: dict[str, Proposal] = {}
    order = sorted(
        (p for p in proposals if p.quantity in ("joint_angle", "joint_command") and not p.out),
        key=lambda p: (p.quantity == "joint_command", p.keys.get("side") == "output"),
    )
    for proposal in order:
        found.setdefault(proposal.place[1], proposal)
    return [p for p in proposals if p in found.values()]


def plain_name(text: str) -> str:
    """Return a text as a name of a record's table."""
    return re.sub(r"[^\w-]+", "_", text).strip("_") or "log"
