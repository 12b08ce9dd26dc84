"""Columns that are coordinates, quaternions and angles of one thing, by their names and values."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from flexarm.importing.guess.logged import Logged
from flexarm.importing.guess.words import ROTATIONS, Meaning, words_of


def named_by_direction(columns: Sequence[Logged]) -> list[Logged]:
    """Return the columns, as coordinates x, y, z those that are named E, N and H together."""
    groups: dict[tuple[Any, str], dict[str, Logged]] = {}
    for column in columns:
        head, _, last = column.meaning.stem.rpartition(" ")
        if last in ("e", "n", "h") and not column.meaning.axis:
            groups.setdefault((column.kind, head), {})[last] = column
    axes = dict(zip("enh", "xyz", strict=True))
    whole = {
        id(column): replace(
            column,
            meaning=replace(
                column.meaning, quantity="position", axis=axes[last], stem=head, why="east, north, height"
            ),
        )
        for (_, head), group in groups.items()
        if len(group) == len(axes)
        for last, column in group.items()
    }
    return [whole.get(id(column), column) for column in columns]


def with_quaternions(columns: Sequence[Logged]) -> list[Logged]:
    """Return the columns, as an orientation four whose squares sum to 1.

    They stand in a row of one table, and their names differ by numbers alone.
    """
    found = list(columns)
    rounded = 1e-3  # how far the sum may be from 1
    for k in range(len(found) - 3):
        four = found[k : k + 4]
        stems = {(c.kind, re.sub(r"\d+", "", c.meaning.stem), c.meaning.axis) for c in four}
        length = sum(np.square(c.values) for c in four if len(c.values) == len(four[0].values))
        if len(stems) == 1 and not four[0].meaning.axis and np.nanmax(np.abs(length - 1.0)) < rounded:
            why = "squares of four columns sum to 1"
            turned = [replace(c.meaning, quantity="orientation", stem="", why=why) for c in four]
            found[k : k + 4] = [
                replace(c, meaning=replace(m, axis=axis))
                for c, m, axis in zip(four, turned, "wxyz", strict=True)
            ]
    return found


def with_rotations(columns: Sequence[Logged]) -> list[Logged]:
    """Return the columns, as an orientation three that are named as angles beside x, y, z of a point."""

    def unit_of(column: Logged) -> str:
        return column.meaning.unit.replace("A", "")  # that of A, B, C is no ampere

    groups: dict[tuple[Any, str], dict[str, Logged]] = {}
    for column in columns:
        words = words_of(str(column.column))
        *heads, last = [word for word in words if word != unit_of(column).lower()] or [""]
        groups.setdefault((column.kind, " ".join(heads)), {})[last] = column
    found: dict[int, Logged] = {}
    for (_, head), group in groups.items():
        beside = [group[axis].meaning.quantity for axis in "xyz" if axis in group]
        for names, rotation in ROTATIONS.items() if beside == ["position"] * 3 else ():
            if group.keys() >= set(names):
                why = f"{', '.join(names)} beside x, y, z"
                for name, axis in zip(names, "xyz", strict=True):
                    column = group[name]
                    meaning = Meaning("orientation", axis, head, unit_of(column), why, rotation)
                    found[id(column)] = replace(column, meaning=meaning)
    return [found.get(id(column), column) for column in columns]
