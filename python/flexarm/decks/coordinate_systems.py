r"""Coordinate systems of Nastran (CORD1, CORD2; rectangular, cylindrical, spherical) and grids given in them.

Three points, given in another system (CORD2) or as grids (CORD1), define a system: A is its origin, B lies on
its z axis, C in its xz plane:

.. math:: z = \frac{B - A}{|B - A|}, \quad y = \frac{z \times (C - A)}{|..|}, \quad x = y \times z   (1)

With R = (x, y, z) the point of coordinates r, theta, z or r, theta (from z), phi stands at

.. math:: p = A + R \, (r \cos\theta, r \sin\theta, z) \quad\text{or}\quad
          A + R \, (r \sin\theta \cos\phi, r \sin\theta \sin\phi, r \cos\theta)                      (2)

Angles are in degrees. Source: MSC Nastran Quick Reference Guide, entries CORD1R, CORD2R, GRID, GRDSET.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from flexarm.arrays import Floats
from flexarm.decks.cards import Card


@dataclass(frozen=True, eq=False)
class System:
    """A system with its origin and, as columns, its axes; `kind` is R, C or S."""

    kind: str
    origin: Floats
    axes: Floats

    def point(self, coordinates: Floats) -> Floats:
        """Return a point of the system in the basic one, eq. (2)."""
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


class Grids:
    """GRID cards of a bulk data file by number, and coordinate systems, which may refer to one another."""

    def __init__(self) -> None:
        self.cards: dict[int, Card] = {}
        self._default: Card | None = None
        self._definitions: dict[int, tuple[Card, int]] = {}
        self._built = {0: System("R", np.zeros(3), np.eye(3))}
        self._pending: list[int] = []

    def take(self, card: Card) -> None:
        """Read a GRID, GRDSET or CORD card; others are ignored."""
        if card.name == "GRID":
            self.cards[card.integer(0)] = card
        elif card.name == "GRDSET":
            self._default = card
        elif card.name.startswith("CORD"):
            if not re.fullmatch("CORD[12][RCS]", card.name):
                raise card.error("is not read; allowed are CORD1R, CORD1C, CORD1S, CORD2R, CORD2C, CORD2S")
            for first in (0, 4) if card.name.startswith("CORD1") else (0,):
                if first == 0 or card.text(first):
                    self._definitions[card.integer(first)] = (card, first)

    def position(self, number: int) -> Floats:
        """Return a grid's position in the basic system, in the file's unit."""
        card = self.cards[number]
        return self._of(card, 1).point(card.vector(2))

    def axes(self, number: int) -> Floats:
        """Return the axes of a grid's freedoms, as columns."""
        return self._of(self.cards[number], 5).axes_at(self.position(number))

    def _of(self, card: Card, field: int) -> System:
        """Return the system that a GRID names in a field, or GRDSET, or the basic one."""
        named_by = card if card.text(field) or self._default is None else self._default
        return self._system(named_by.integer(field, 0), card)

    def _system(self, number: int, user: Card) -> System:
        if number in self._built:
            return self._built[number]
        if number not in self._definitions:
            raise user.error(f"is in coordinate system {number}, which is not in the file")
        if number in self._pending:
            raise user.error(f"coordinate system {number} is defined by itself")
        card, first = self._definitions[number]
        self._pending.append(number)
        if card.name.startswith("CORD2"):
            reference = self._system(card.integer(1, 0), card)
            A, B, C = (reference.point(card.vector(i)) for i in (2, 5, 8))
        else:
            A, B, C = (self._corner(card, card.integer(first + i)) for i in (1, 2, 3))
        self._pending.pop()
        z, across = B - A, np.cross(B - A, C - A)
        if not np.linalg.norm(across) > 1e-9 * np.linalg.norm(z) * np.linalg.norm(C - A):
            raise card.error("its three points lie on one line")
        z, y = z / np.linalg.norm(z), across / np.linalg.norm(across)  # eq. (1)
        self._built[number] = System(card.name[5], A, np.column_stack([np.cross(y, z), y, z]))
        return self._built[number]

    def _corner(self, card: Card, grid: int) -> Floats:
        if grid not in self.cards:
            raise card.error(f"names grid {grid}, which is not in the file")
        return self.position(grid)
