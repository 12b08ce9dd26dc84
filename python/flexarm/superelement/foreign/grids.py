r"""Positions of the points of a matrix, and the axes of their freedoms.

From Nastran bulk data (GRID, CORD1 and CORD2, rectangular, cylindrical and spherical, fields fixed, large or
free) or from *NODE of Abaqus and CalculiX. A system (A, B, C) has its origin in A, z towards B, and C in the
x-z plane; the axes of a curvilinear system at a point are the radial, the circumferential and the third
direction there:

.. math:: p = A + R \, (r \cos\theta, r \sin\theta, z) \quad\text{or}\quad
          A + R \, (r \sin\theta \cos\phi, r \sin\theta \sin\phi, r \cos\theta)                      (1)

Source: MSC Nastran Quick Reference Guide, entries CORD2R, CORD2C, CORD2S, GRID.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import InvalidFile
from flexarm.reading import any_text
from flexarm.superelement.foreign.cards import Card, cards_of


@dataclass(frozen=True, eq=False)
class Grid:
    """A point: its position in the part's frame, in the file's unit, and its freedoms' axes as columns."""

    position: Floats
    axes: Floats


@dataclass(frozen=True, eq=False)
class _System:
    kind: str
    origin: Floats
    axes: Floats

    def point(self, coordinates: Floats) -> Floats:
        """Return a point of the system in the basic one, eq. (1)."""
        a, b, c = coordinates
        t, f = np.deg2rad(b), np.deg2rad(c)
        local = {
            "R": np.array([a, b, c]),
            "C": np.array([a * np.cos(t), a * np.sin(t), c]),
            "S": a * np.array([np.sin(t) * np.cos(f), np.sin(t) * np.sin(f), np.cos(t)]),
        }[self.kind]
        return np.asarray(self.origin + self.axes @ local)

    def axes_at(self, position: Floats) -> Floats:
        """Return the directions of the three coordinates at a point of the basic system."""
        x, y, z = self.axes.T @ (position - self.origin)
        if self.kind == "R" or (x == 0 and y == 0 and self.kind == "C"):
            return self.axes
        f = np.arctan2(y, x)
        around = np.array([-np.sin(f), np.cos(f), 0.0])
        if self.kind == "C":
            local = np.column_stack([[np.cos(f), np.sin(f), 0.0], around, [0.0, 0.0, 1.0]])
        else:
            t = np.arctan2(np.hypot(x, y), z)
            out = np.array([np.sin(t) * np.cos(f), np.sin(t) * np.sin(f), np.cos(t)])
            local = np.column_stack([out, np.cross(around, out), around])
        return np.asarray(self.axes @ local)


def read_grids(path: str | Path) -> dict[int, Grid]:
    """Read the points of a bulk data file or an input deck.

    Raises
    ------
    InvalidFile
        If the file cannot be read, holds no points, or refers to systems that it does not define.
    """
    path = Path(path)
    text = any_text(path)
    upper = text.upper()
    grids = _nodes(path, text) if "*NODE" in upper else _bulk(path, text)
    if not grids:
        raise InvalidFile(path, "grids", "holds no GRID entry and no *NODE")
    return grids


def _bulk(path: Path, text: str) -> dict[int, Grid]:
    cards = list(cards_of(path, text))
    grids = {card.integer(1): card for card in cards if card.name == "GRID"}
    default = next((card for card in cards if card.name == "GRDSET"), None)
    systems = _systems(path, cards, grids, default)
    found = {}
    for number, card in grids.items():
        position = systems(_choice(card, default, 2)).point(card.vector(3))
        found[number] = Grid(position, systems(_choice(card, default, 6)).axes_at(position))
    return found


def _choice(card: Card, default: Card | None, field: int) -> int:
    """Return the coordinate system of a grid: its own, that of GRDSET, or the basic one."""
    if card.blank(field) and default is not None:
        return default.integer(field, 0)
    return card.integer(field, 0)


def _systems(
    path: Path, cards: list[Card], grids: dict[int, Card], default: Card | None
) -> Callable[[int], _System]:
    """Return coordinate systems by number, built on request, since they may refer to one another."""
    definitions = {}
    for card in cards:
        if card.name in ("CORD2R", "CORD2C", "CORD2S", "CORD1R", "CORD1C", "CORD1S"):
            definitions[card.integer(1)] = (card, 1)
            if card.name.startswith("CORD1") and not card.blank(5):
                definitions[card.integer(5)] = (card, 5)
    built = {0: _System("R", np.zeros(3), np.eye(3))}
    pending: list[int] = []

    def system(number: int) -> _System:
        if number in built:
            return built[number]
        if number not in definitions or number in pending:
            why = "refers to itself" if number in pending else "is not defined"
            raise InvalidFile(path, f"coordinate system {number}", why)
        pending.append(number)
        card, at = definitions[number]
        built[number] = _from_points(path, card.name[5], number, list(corners(card, at)))
        pending.pop()
        return built[number]

    def corners(card: Card, at: int) -> Iterator[Floats]:
        if card.name.startswith("CORD2"):
            reference = system(card.integer(2, 0))
            yield from (reference.point(card.vector(i)) for i in (3, 6, 9))
            return
        for i in (at + 1, at + 2, at + 3):
            if card.integer(i) not in grids:
                raise InvalidFile(path, card.name, f"grid {card.integer(i)} is not defined", line=card.line)
            grid = grids[card.integer(i)]
            yield system(_choice(grid, default, 2)).point(grid.vector(3))

    return system


def _from_points(path: Path, kind: str, number: int, corners: list[Floats]) -> _System:
    A, B, C = corners
    z, across = B - A, np.cross(B - A, C - A)
    if np.linalg.norm(across) < 1e-9 * np.linalg.norm(z) * np.linalg.norm(C - A) or not np.any(z):
        raise InvalidFile(path, f"coordinate system {number}", "its three points must not stand in a line")
    z, y = z / np.linalg.norm(z), across / np.linalg.norm(across)
    return _System(kind, A, np.column_stack([np.cross(y, z), y, z]))


def _nodes(path: Path, text: str) -> dict[int, Grid]:
    """Read the points of *NODE; freedoms point along the global axes."""
    grids: dict[int, Grid] = {}
    inside = False
    for number, line in enumerate(text.splitlines(), 1):
        bare = line.strip()
        if bare.startswith("*") and not bare.startswith("**"):
            keyword = bare.split(",")[0].upper()
            inside = keyword == "*NODE"
            if keyword == "*TRANSFORM":
                raise InvalidFile(path, keyword, "turned freedoms are not read; state none", line=number)
        elif inside and bare and not bare.startswith("**"):
            try:
                words = [word.strip() for word in bare.split(",")]
                grids[int(words[0])] = Grid(
                    np.array([float(word or 0) for word in (*words[1:4], *"000")[:3]]), np.eye(3)
                )
            except ValueError:
                what = f"must be number, x, y, z; got {bare!r}"
                raise InvalidFile(path, "*NODE", what, line=number) from None
    return grids
