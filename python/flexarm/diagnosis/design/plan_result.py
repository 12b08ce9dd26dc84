"""The result of `flexarm.plan`: which effects a planned experiment could separate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf, sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexarm.arguments import takes
from flexarm.arm.consistency import missing
from flexarm.diagnosis.policy import DESIGN, SelectionPolicy
from flexarm.errors import InvalidParameter
from flexarm.output import SavedAsDirectory
from flexarm.pictures import Summarised
from flexarm.report import plan as plan_report

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from flexarm.arm import Arm


Place = tuple[str, str]


@dataclass(frozen=True)
class PlannedEffect:
    """An effect at a place, at a plausible size.

    Attributes
    ----------
    name, at : str
        Effect and place.
    parameter, unit : str
        What says how large it is.
    value, null : float
        Of that parameter: the plausible one, and the one without effect (infinite for a spring).
    least : float
        Where it begins to be detected, on the way from `null` to `value` and beyond.
    log_bayes_factor : float
        Expected, of the effect at `value` over no effect.
    hidden : str
        Why it is not seen at any plausible size; empty where it is.
    """

    name: str
    at: str
    parameter: str
    unit: str
    value: float
    null: float
    least: float
    log_bayes_factor: float
    hidden: str = ""

    @property
    def place(self) -> Place:
        """Name and place."""
        return self.name, self.at

    @property
    def seen(self) -> bool:
        """Return True if the experiment would show it at the plausible size."""
        return self.log_bayes_factor >= SelectionPolicy.strong_evidence

    @property
    def times(self) -> float:
        """The least size over the plausible one."""
        return (
            sqrt(SelectionPolicy.strong_evidence / self.log_bayes_factor)
            if self.log_bayes_factor > 0
            else inf
        )

    @property
    def detectable(self) -> bool:
        """Return True if the least size is within `DESIGN.far` plausible ones."""
        return self.times <= DESIGN.far


@dataclass(frozen=True)
class Parting:
    """The effect of an additional measurement on an indistinguishable pair.

    Attributes
    ----------
    addition : str
        What is added.
    minutes : float
        Its cost, roughly.
    log_bayes_factor : float
        Expected with it.
    """

    addition: str
    minutes: float
    log_bayes_factor: float

    @property
    def parts(self) -> bool:
        """Return True if the pair is tied no more."""
        return self.log_bayes_factor >= SelectionPolicy.reach


@dataclass(frozen=True)
class Tie:
    """Two effects that the experiment cannot part.

    Attributes
    ----------
    one, other : (str, str)
        Names and places.
    log_bayes_factor : float
        Expected, of the right over the wrong name.
    partings : tuple of Parting
        Additions: first those that part the pair, the cheapest first.
    """

    one: Place
    other: Place
    log_bayes_factor: float
    partings: tuple[Parting, ...]

    @property
    def cheapest(self) -> Parting | None:
        """The cheapest addition that parts the pair."""
        return next((each for each in self.partings if each.parts), None)


@dataclass(frozen=True, eq=False, repr=False)
class Plan(SavedAsDirectory, Summarised):
    """The effects that an experiment could separate.

    Attributes
    ----------
    arm : Arm
        The nominal model.
    runs : tuple of str
        Names of the motions.
    effects : tuple of PlannedEffect
        Every effect at every place.
    log_bayes_factor : ndarray, shape (effects, effects)
        Expected logarithm of the evidence for effect i, which is there, over that for effect j.
    groups : tuple of tuple of int
        Effects of which no two can be told apart, by number.
    ties : tuple of Tie
        Pairs, and what would part them.
    assumed : tuple of str
        What nobody stated of sensors, clocks and frames.
    provenance : dict
        version, seconds.
    """

    arm: Arm
    runs: tuple[str, ...]
    effects: tuple[PlannedEffect, ...]
    log_bayes_factor: NDArray[np.float64]
    groups: tuple[tuple[int, ...], ...]
    ties: tuple[Tie, ...]
    assumed: tuple[str, ...] = ()
    provenance: Mapping[str, Any] = field(default_factory=dict)

    @takes()
    def effect(self, name: str, at: str) -> PlannedEffect:
        """Return an effect by name and place.

        Raise InvalidParameter if it was not planned for.
        """
        for each in self.effects:
            if each.place == (name, at):
                return each
        planned = [f"{each.name} at {each.at}" for each in self.effects]
        raise InvalidParameter(missing("planned effect", f"{name} at {at}", planned))

    def tie(self, one: Place, other: Place) -> Tie | None:
        """Return the tie of two effects; None if the experiment parts them."""
        return next((t for t in self.ties if {t.one, t.other} == {one, other}), None)

    def alone(self) -> tuple[PlannedEffect, ...]:
        """Effects that are seen and could be taken for no other one."""
        tied = {i for group in self.groups for i in group}
        return tuple(e for i, e in enumerate(self.effects) if e.seen and i not in tied)

    def additions(self) -> list[tuple[str, float, int]]:
        """Return what may be added, its cost in minutes, and how many of the tied pairs it parts; the best
        first.
        """
        found: dict[str, tuple[float, int]] = {}
        for tie in self.ties:
            for each in tie.partings:
                _, count = found.get(each.addition, (0.0, 0))
                found[each.addition] = (each.minutes, count + each.parts)
        rows = [(words, minutes, count) for words, (minutes, count) in found.items()]
        return sorted(rows, key=lambda row: (-row[2], row[1]))

    @property
    def thresholds(self) -> dict[str, float]:
        """Return the expected ln Bayes factors from which an effect is detected, and a pair is told apart."""
        return {"detected": SelectionPolicy.strong_evidence, "parted": SelectionPolicy.reach}

    def rivals(self, i: int) -> list[int]:
        """Effects that would do in the place of one, by number."""
        row = self.log_bayes_factor[i]
        return [int(j) for j in np.argsort(row, kind="stable") if j != i and row[j] < SelectionPolicy.reach]

    # ------------------------------------------------------------------- output

    def headline(self) -> str:
        """Return the plan in a sentence."""
        return plan_report.headline(self)

    def summary(self) -> str:
        """Sizes that are seen, groups that cannot be parted, and what would part them, as text."""
        return plan_report.summary(self)

    def to_json_dict(self) -> dict[str, Any]:
        """Return the object of `plan.json`; what is infinite becomes null."""
        return plan_report.plan_dict(self)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Return the matrix of expected log Bayes factors.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw.
        """
        return plan_report.draw_matrix(self, ax)

    def write(self, directory: Path) -> None:
        """Write plan.json, plan.html and the figures into a directory that is there."""
        plan_report.write(self, directory)
