"""Nodes, cells and sets of an Abaqus part, or of the whole of a file without parts.

A node or cell is known by its instance and its number, since each part counts from 1; in a file without
parts, and within a part, the instance is empty.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Generic, TypeVar

import numpy as np

from flexarm.arrays import Floats
from flexarm.decks.keywords import Keyword

Key = tuple[str, int]
#: A range of more numbers than this is looked up among the nodes or cells that there are.
Value = TypeVar("Value")


class Names(Generic[Value]):
    """Values by names that do not distinguish capitals; the spelling first met is kept."""

    def __init__(self) -> None:
        self._values: dict[str, tuple[str, Value]] = {}

    def get(self, name: str) -> Value | None:
        """Return the value of a name, or None."""
        found = self._values.get(name.upper())
        return found[1] if found else None

    def set(self, name: str, value: Value) -> None:
        """Give a name its value."""
        spelling = self._values.get(name.upper(), (name, value))[0]
        self._values[name.upper()] = (spelling, value)

    def items(self) -> Iterator[tuple[str, Value]]:
        """Return the names as they were first spelt, and values."""
        yield from self._values.values()

    def __contains__(self, name: str) -> bool:
        return name.upper() in self._values


@dataclass
class Section:
    """A `*SOLID SECTION`: which set of cells has which material."""

    cells: str
    material: str
    where: str


@dataclass
class Scope:
    """The content of one part, of the assembly, or of a file without parts."""

    nodes: dict[Key, list[float]] = field(default_factory=dict)
    cells: dict[Key, tuple[str, list[Key]]] = field(default_factory=dict)
    node_sets: Names[list[Key]] = field(default_factory=Names)
    cell_sets: Names[list[Key]] = field(default_factory=Names)
    surfaces: Names[list[Key]] = field(default_factory=Names)
    sections: list[Section] = field(default_factory=list)

    def copied(self, instance: str, rows: Iterable[list[float]], into: Scope) -> None:
        """Put an instance of this part into the assembly; `rows` are the data of `*INSTANCE`."""

        def own(keys: list[Key]) -> list[Key]:
            return [(instance.upper(), number) for _, number in keys]

        placed = _placed(np.array(list(self.nodes.values())).reshape(-1, 3), list(rows))
        into.nodes.update(zip(own(list(self.nodes)), placed.tolist(), strict=True))
        for key, (kind, nodes) in self.cells.items():
            into.cells[instance.upper(), key[1]] = (kind, own(nodes))
        for mine, its in (
            (self.node_sets, into.node_sets),
            (self.cell_sets, into.cell_sets),
            (self.surfaces, into.surfaces),
        ):
            for name, keys in mine.items():
                its.set(f"{instance}.{name}", own(keys))
        into.sections += [Section(f"{instance}.{s.cells}", s.material, s.where) for s in self.sections]

    def members(
        self, keyword: Keyword, known: Names[list[Key]], there: Mapping[Key, object], instance: str
    ) -> list[Key]:
        """Return the members that the rows of `*NSET` or `*ELSET` name: numbers, ranges, other sets.

        A range longer than any list of nodes, as in `1, 99999999`, means those `there` that it spans.
        """
        many = 1_000_000
        found: list[Key] = []
        for line, values in keyword.rows:
            if "GENERATE" in keyword.parameters:
                span = keyword.span(line, values)
                numbers = (
                    span
                    if len(span) < many
                    else [n for owner, n in there if owner == instance.upper() and n in span]
                )
                found += [(instance.upper(), n) for n in numbers]
                continue
            for value in filter(None, values):
                found += self._named(value, keyword, line, known, instance)
        return found

    def _named(
        self, value: str, keyword: Keyword, line: int, known: Names[list[Key]], instance: str
    ) -> list[Key]:
        if value.isdecimal():
            return [(instance.upper(), *keyword.numbers(line, [value]))]  # type: ignore[list-item]
        owner, _, number = value.rpartition(".")
        if owner and number.isdecimal() and value not in known:
            return [(owner.upper(), *keyword.numbers(line, [number]))]  # type: ignore[list-item]
        of_instance = known.get(f"{instance}.{value}") if instance else None
        named = of_instance if of_instance is not None else known.get(value)
        if named is None:
            raise keyword.error(f"there is no set {value!r} before this line", line)
        return named


def placement(keyword: Keyword) -> list[list[float]]:
    """Return the rows of `*INSTANCE`: none, a translation, or a translation and two points with an angle."""
    rows = [(line, keyword.floats(line, values)) for line, values in keyword.rows]
    for (line, row), length in zip(rows, (3, 7), strict=False):
        if len(row) < length or (length == 7 and row[:3] == row[3:6]):
            what = "three numbers" if length == 3 else "two points of the axis that differ, and an angle"
            raise keyword.error(f"must be {what}, got {', '.join(f'{x:g}' for x in row)}", line)
    return [row for _, row in rows]


def _placed(points: Floats, rows: list[list[float]]) -> Floats:
    """Place the points of a part: translated by the first row, then rotated by the second.

    The second row is two points a, b and an angle [deg] about the line from a to b (Rodrigues' formula).
    """
    if rows:
        points = points + np.array(rows[0][:3])
    if len(rows) > 1:
        a, b, angle = np.array(rows[1][:3]), np.array(rows[1][3:6]), np.radians(rows[1][6])
        axis, arm = (b - a) / np.linalg.norm(b - a), points - a
        along = np.outer(arm @ axis, axis)
        points = a + along + (arm - along) * np.cos(angle) + np.cross(axis, arm) * np.sin(angle)
    return points
