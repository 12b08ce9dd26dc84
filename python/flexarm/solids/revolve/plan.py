"""The part seen along its axis: circles divided evenly, and a core of squares where the axis is solid.

    (x, y) = r (cos t, sin t),   t = 2 pi k / n                                                     (1)

A cell that reached the axis would have an edge of length zero, so the disc inside the smallest circle is an
O-grid: a bulged square of (n/4) x (n/4) cells, whose outline has n points at the angles of (1), and rings
between that outline and the circle. With s, t in [-1, 1], u = tan(pi s/4), v = tan(pi t/4),

    p = (c/2) [ (u, v) + max(|u|, |v|) (u, v) / |(u, v)| ]                                          (2)

turned by 45 degrees: half a square, half a circle, so that at the outline's four corners, where three cells
meet, none of them has an angle near 90 (the two rings would be flat) or 180 degrees (the square would be).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexarm.arrays import Floats, Ints

#: c in (2), as a part of the radius of the circle around the core.
CORE = 0.5


@dataclass(frozen=True)
class Plan:
    """Points and quadrilaterals in the plane normal to the axis."""

    points: Floats
    """x, y [m]."""
    circle: Floats
    """Radius of the circle that a point lies on [m], nan inside the core."""
    quads: Ints
    """Corners, anticlockwise."""
    column: Ints
    """Index of the line at each quad's inner radius; the core belongs to line 0."""


def plan_of(radii: Floats, around: int, core_size: float) -> Plan:
    """Return the plan of circles at rising `radii`; a first radius of 0 adds a core of `core_size` cells."""
    if radii[0] > 0:
        points = _circles(radii, around)
        quads = _rings(0, len(radii) - 1, around)
        column = np.repeat(np.arange(len(radii) - 1), around)
        return Plan(points, np.repeat(radii, around), quads, column)
    core, square = _core(CORE * radii[1], around)
    outline = core[-around:]
    layers = max(1, round((1 - CORE) * radii[1] / core_size))
    part = np.arange(1, layers)[:, None, None] / layers
    between = (1 - part) * outline + part * _circles(radii[1:2], around)
    points = np.concatenate([core, between.reshape(-1, 2), _circles(radii[1:], around)])
    circle = np.full(len(points), np.nan)
    circle[-around * (len(radii) - 1) :] = np.repeat(radii[1:], around)
    rings = _rings(len(core) - around, layers + len(radii) - 2, around)
    outside = np.repeat(np.arange(1, len(radii) - 1), around)
    column = np.concatenate([np.zeros(len(square) + layers * around, int), outside])
    return Plan(points, circle, np.concatenate([square, rings]), column)


def _circles(radii: Floats, around: int) -> Floats:
    angle = 2 * np.pi * np.arange(around) / around
    directions = np.column_stack([np.cos(angle), np.sin(angle)])
    return np.concatenate([r * directions for r in radii])  # eq. (1)


def _rings(first: int, layers: int, around: int) -> Ints:
    """Return quads between consecutive circles of `around` points, from point `first` outwards."""
    k = np.arange(around)
    inner = first + np.arange(layers)[:, None] * around + k
    following = first + np.arange(layers)[:, None] * around + (k + 1) % around
    quads = np.stack([inner, inner + around, following + around, following], axis=-1)
    return quads.reshape(-1, 4)


def _core(size: float, around: int) -> tuple[Floats, Ints]:
    """Return points and quads of the square; its outline comes last, anticlockwise from the corner on x."""
    n = around // 4
    s, t = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1), indexing="ij")
    uv = np.tan(np.pi / 4 * np.stack([s, t], axis=-1))
    length = np.linalg.norm(uv, axis=-1, keepdims=True)
    largest = np.abs(uv).max(axis=-1, keepdims=True)
    bulged = size / 2 * (uv + largest * uv / np.where(length > 0, length, 1))  # eq. (2)
    turn = np.array([[1.0, 1.0], [-1.0, 1.0]]) / np.sqrt(2)  # by +45 degrees, for row vectors
    points = bulged.reshape(-1, 2) @ turn
    index = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    outline = np.concatenate([index[n, :n], index[n:0:-1, n], index[0, n:0:-1], index[:n, 0]])
    order = np.concatenate([np.setdiff1d(index.ravel(), outline), outline])
    new = np.empty(len(order), dtype=np.int64)
    new[order] = np.arange(len(order))
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1)
    return points[order], new[quads.reshape(-1, 4)]
