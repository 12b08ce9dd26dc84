"""Coordinate systems of Nastran: CORD2R, CORD2C, CORD2S, and grids given in them.

A system is three points in another one: A its origin, B on its z axis, C in its xz plane,

    z = (B - A)/|B - A| ,   y = z x (C - A) / |..| ,   x = y x z                                    (1)

Coordinates in it are x, y, z; or r, theta, z; or r, theta (from z), phi, angles in degrees.       (2)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, radians, sin

import numpy as np

from flexarm.arrays import Floats
from flexarm.solids.reading.cards import Card


@dataclass
class Frame:
    """A system as its card defines it; it may refer to one that comes later."""

    card: Card
    kind: str
    reference: int


def frame_of(card: Card, frames: dict[int, Frame]) -> None:
    """Add the system of a card to `frames`."""
    if card.name not in ("CORD2R", "CORD2C", "CORD2S"):
        raise card.error("is not read; allowed are CORD2R, CORD2C, CORD2S")
    frames[card.integer(0)] = Frame(card, card.name[-1], card.integer(1, 0))


def basic(grid: Card, frames: Mapping[int, Frame]) -> Floats:
    """Return the coordinates of a GRID in the basic system."""
    xyz = np.array([grid.number(i) for i in (2, 3, 4)])
    return _to_basic(xyz, grid.integer(1, 0), frames, grid, 0)


def _to_basic(xyz: Floats, system: int, frames: Mapping[int, Frame], of: Card, depth: int) -> Floats:
    if system == 0:
        return xyz
    if system not in frames:
        raise of.error(f"is in coordinate system {system}, which is not in the file")
    if depth > len(frames):
        raise of.error(f"coordinate system {system} is defined by itself")
    frame = frames[system]
    corners = [np.array([frame.card.number(2 + 3 * k + i) for i in range(3)]) for k in range(3)]
    a, b, c = (_to_basic(p, frame.reference, frames, frame.card, depth + 1) for p in corners)
    normal = np.cross(b - a, c - a)
    if not np.linalg.norm(normal) > 0:
        raise frame.card.error("its three points lie on one line")
    z, y = (b - a) / np.linalg.norm(b - a), normal / np.linalg.norm(normal)  # eq. (1)
    local = _cartesian(xyz, frame.kind)
    return np.asarray(a + local[0] * np.cross(y, z) + local[1] * y + local[2] * z)


def _cartesian(q: Floats, kind: str) -> Floats:
    """Return Cartesian coordinates, eq. (2)."""
    if kind == "R":
        return q
    angle = radians(q[1])
    if kind == "C":
        return np.array([q[0] * cos(angle), q[0] * sin(angle), q[2]])
    around = radians(q[2])
    return np.array([q[0] * sin(angle) * cos(around), q[0] * sin(angle) * sin(around), q[0] * cos(angle)])
