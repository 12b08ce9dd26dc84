"""What a planned experiment could tell apart: the result of `flexarm.plan`, which prints and plots itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf, isfinite, sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexarm.diagnosis.choose import REACH, STRONG
from flexarm.diagnosis.wording import listed, number, place_words, with_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from flexarm.arm import Arm

Place = tuple[str, str]
FORMAT = "flexarm-plan/1"
MOST_TIES = 12
"""Tied pairs that are printed; the file plan.json has all."""
SMALL = 0.05
"""Change of a nominal value that is told as such."""
FAR = 10.0
"""Sizes beyond so many times the plausible one are not stated: the law need not be linear so far."""


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
        Why it moves nothing that is measured, whatever its size; empty where it does.
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
        """Whether the experiment would show it at the plausible size."""
        return self.log_bayes_factor >= STRONG

    @property
    def times(self) -> float:
        """The least size over the plausible one."""
        return sqrt(STRONG / self.log_bayes_factor) if self.log_bayes_factor > 0 else inf

    @property
    def least_words(self) -> str:
        """The smallest detectable size, for a person: a value, or a change of the nominal one."""
        if self.times > FAR:
            return "not seen"
        if self.null == inf:
            return f"softer than {with_unit(self.least, self.unit)}"
        size = with_unit(abs(self.least - self.null), self.unit)
        return f"± {size}" if self.null else size

    @property
    def value_words(self) -> str:
        """The plausible size, for a person; of a small change the change."""
        change = self.value - self.null
        if isfinite(self.null) and 0 < abs(change) < SMALL * abs(self.null):
            sign = "+" if change > 0 else "-"
            return f"{self.parameter} = {self.null:g} {sign} {with_unit(abs(change), self.unit)}"
        return f"{self.parameter} = {with_unit(self.value, self.unit)}"


@dataclass(frozen=True)
class Parting:
    """What an addition does for a tied pair.

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
        """Whether the pair is tied no more."""
        return self.log_bayes_factor >= REACH


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
class Plan:
    """What an experiment could tell apart.

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

    def effect(self, name: str, at: str) -> PlannedEffect:
        """An effect by name and place.

        Raises
        ------
        KeyError
            If it was not planned for.
        """
        return next((e for e in self.effects if e.place == (name, at)), None) or _missing(name, at)

    def tie(self, one: Place, other: Place) -> Tie | None:
        """The tie of two effects; None if the experiment parts them."""
        return next((t for t in self.ties if {t.one, t.other} == {one, other}), None)

    def alone(self) -> tuple[PlannedEffect, ...]:
        """Effects that are seen and could be taken for no other one."""
        tied = {i for group in self.groups for i in group}
        return tuple(e for i, e in enumerate(self.effects) if e.seen and i not in tied)

    def additions(self) -> list[tuple[str, float, int]]:
        """What may be added, its cost in minutes, and how many of the tied pairs it parts; the best first."""
        found: dict[str, tuple[float, int]] = {}
        for tie in self.ties:
            for each in tie.partings:
                _, count = found.get(each.addition, (0.0, 0))
                found[each.addition] = (each.minutes, count + each.parts)
        rows = [(words, minutes, count) for words, (minutes, count) in found.items()]
        return sorted(rows, key=lambda row: (-row[2], row[1]))

    # ------------------------------------------------------------------- output

    def headline(self) -> str:
        """The plan in a sentence."""
        seen = [e for e in self.effects if e.seen]
        text = (
            f"of {len(self.effects)} effects the experiment would show {len(seen)} at a plausible size and "
            f"tell {len(self.alone())} of them from all others"
        )
        if not self.ties:
            return text + "."
        words, minutes, count = self.additions()[0] if self.additions() else ("", 0.0, 0)
        if not count:
            return text + f"; nothing on the menu parts any of the {len(self.ties)} tied pairs."
        return text + (
            f"; a run {words} (some {minutes:g} min) would part {count} of the {len(self.ties)} tied pairs."
        )

    def summary(self) -> str:
        """Sizes that are seen, groups that cannot be parted, and what would part them, as text."""
        lines = [f"plan of {self.arm.name}: {', '.join(self.runs)}", self.headline(), ""]
        lines += [f"assumed: {sentence}" for sentence in self.assumed]
        lines += ["", *self._effect_lines(), "", *self._group_lines()]
        return "\n".join([*lines, *self._addition_lines()]).replace("\n\n\n", "\n\n")

    def __repr__(self) -> str:
        return self.summary()

    def _effect_lines(self) -> list[str]:
        rows = [("effect", "smallest detectable", "at plausible", "ln B", "taken for, or why not seen")]
        for i, each in enumerate(self.effects):
            rivals = [place_words(*self.effects[j].place) for j in self.rivals(i)]
            shown = ", ".join(rivals[:2]) + (f" and {len(rivals) - 2} more" if len(rivals) > 2 else "")
            rows.append(
                (
                    place_words(*each.place),
                    each.least_words,
                    each.value_words,
                    number(each.log_bayes_factor),
                    shown if each.seen else each.hidden,
                )
            )
        widths = [max(len(row[k]) for row in rows) for k in range(5)]
        return [
            "  ".join(f"{cell:<{w}}" for cell, w in zip(row, widths, strict=True)).rstrip() for row in rows
        ]

    def rivals(self, i: int) -> list[int]:
        """Effects that would do in the place of one, by number."""
        row = self.log_bayes_factor[i]
        return [int(j) for j in np.argsort(row, kind="stable") if j != i and row[j] < REACH]

    def _group_lines(self) -> list[str]:
        if not self.groups:
            return ["every effect that is seen can be told from every other one"]
        lines = ["cannot be told apart (expected ln Bayes factor below ln 20):"]
        for group in self.groups:
            lines.append("  " + listed([place_words(*self.effects[i].place) for i in group]))
        return lines

    def _addition_lines(self) -> list[str]:
        if not self.ties:
            return []
        lines = ["", f"what may be added, and how many of {len(self.ties)} tied pairs it parts:"]
        for words, minutes, count in self.additions():
            lines.append(f"  {count:4d}  {words} (some {minutes:g} min)")
        lines += ["", "cheapest addition by pair:"]
        lines += [f"  {_tie_words(tie)}" for tie in self.ties[:MOST_TIES]]
        more = len(self.ties) - MOST_TIES
        return [*lines, f"  and {more} more pairs (plan.json of --out has all)"] if more > 0 else lines

    def to_json_dict(self) -> dict[str, Any]:
        """The object of `plan.json`; what is infinite becomes null."""
        return {
            "format": FORMAT,
            "model": self.arm.name,
            "runs": list(self.runs),
            "assumed": list(self.assumed),
            "thresholds": {"detected": STRONG, "parted": REACH},
            "effects": [
                {
                    "name": each.name,
                    "at": each.at,
                    "parameter": each.parameter,
                    "unit": each.unit,
                    "value": _finite(each.value),
                    "null": _finite(each.null),
                    "smallest_detectable": _finite(each.least) if each.times <= FAR else None,
                    "log_bayes_factor": _finite(each.log_bayes_factor),
                    "seen": each.seen,
                    "hidden": each.hidden,
                }
                for each in self.effects
            ],
            "log_bayes_factor": [[_finite(x) for x in row] for row in self.log_bayes_factor],
            "groups": [
                [{"name": self.effects[i].name, "at": self.effects[i].at} for i in group]
                for group in self.groups
            ],
            "ties": [_tie(each) for each in self.ties],
            "provenance": dict(self.provenance),
        }

    def plot(self, ax: Axes | None = None) -> Axes:
        """The matrix of expected log Bayes factors.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw.
        """
        from flexarm.diagnosis.plan_curves import draw_matrix

        return draw_matrix(self, ax)

    def save(self, directory: str | Path, force: bool = False) -> None:
        """Writes plan.json, plan.html and the figures, all of them or none.

        Parameters
        ----------
        directory : str or Path
            A new or empty directory.
        force : bool
            Write into a directory that holds files.

        Raises
        ------
        InvalidFile
            If the directory holds files, or cannot be written.
        """
        from flexarm.output import output_directory
        from flexarm.report.plan_page import write  # draws this; so it is imported when it is asked for

        with output_directory(directory, force) as place:
            write(self, place)


def _tie_words(tie: Tie) -> str:
    pair, best = f"{place_words(*tie.one)} | {place_words(*tie.other)}", tie.cheapest
    if best is None:
        return f"{pair}: nothing on the menu"
    before, after = number(tie.log_bayes_factor, 2), number(best.log_bayes_factor)
    return f"{pair}: {best.addition}, ln B {before} -> {after}"


def _tie(tie: Tie) -> dict[str, Any]:
    return {
        "effects": [{"name": name, "at": at} for name, at in (tie.one, tie.other)],
        "log_bayes_factor": _finite(tie.log_bayes_factor),
        "additions": [
            {
                "addition": each.addition,
                "minutes": each.minutes,
                "log_bayes_factor": _finite(each.log_bayes_factor),
                "parts": each.parts,
            }
            for each in tie.partings
        ],
    }


def _finite(value: float) -> float | None:
    return float(value) if isfinite(value) else None


def _missing(name: str, at: str) -> PlannedEffect:
    raise KeyError(f"{name} at {at} was not planned for")
