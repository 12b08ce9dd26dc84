"""Bodies as triangles: tubes and boxes along bones, spheres, arrows, frames.

A skin is a surface whose corners hang on bones; corner v of the surface lies at

    p_v = sum_k w_vk (x_k + R_k c_vk)                                                                 (1)

with c_vk its place in the frame of bone k. Most corners hang on one bone; those of a mesh between interfaces
on all, with weights that fall with the square of the distance, so that rigid motion does not deform it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexarm.arm.link import Beam
from flexarm.arm.rotation import from_axes
from flexarm.arm.section import General, Rectangle, Round, Section, Tube
from flexarm.arrays import Floats, Ints

ROUND = 24
"""Corners of what is drawn round."""


@dataclass(frozen=True)
class Skin:
    """A surface, or lines, on bones."""

    layer: str
    name: str
    """What it belongs to, and its own name."""
    bone: Ints
    """Bones that each corner hangs on; -1 is the base, shape (corner, k)."""
    place: Floats
    """Where, in the bones' frames [m], shape (corner, k, 3)."""
    faces: Ints
    """Corners of triangles, or of lines, shape (n, 3) or (n, 2)."""
    colour: str
    """Such as "#1f77b4"."""
    weight: Floats | None = None
    """Of the bones; None: one bone each, shape (corner, k)."""
    opacity: float = 1.0
    """0 to 1."""
    flat: bool = False
    """Faces are shaded flat, which keeps edges of meshes sharp."""

    def shifted(self, bones: int, layer: str, colour: str, opacity: float) -> Skin:
        """Return a copy on other bones, for a second arm beside the first."""
        bone = np.where(self.bone < 0, self.bone, self.bone + bones)
        return replace(self, bone=bone, layer=layer, colour=colour, opacity=opacity)


@dataclass(frozen=True)
class Surface:
    """Corners (n, 3) [m] and triangles (m, 3)."""

    corners: Floats
    faces: Ints

    def moved(self, rotation: Floats, position: Floats) -> Surface:
        """Return the surface turned, then shifted."""
        return Surface(self.corners @ np.asarray(rotation).T + np.asarray(position), self.faces)

    def on(self, bone: int, layer: str, name: str, colour: str) -> Skin:
        """Return it as a skin on one bone."""
        bones = np.full((len(self.corners), 1), bone)
        return Skin(layer, name, bones, self.corners[:, None], self.faces, colour)


def joined(*surfaces: Surface) -> Surface:
    """Return several surfaces as one."""
    starts = np.cumsum([0, *(len(each.corners) for each in surfaces)])
    return Surface(
        np.concatenate([each.corners for each in surfaces]),
        np.concatenate([each.faces + start for each, start in zip(surfaces, starts, strict=False)]),
    )


def swept(outline: Floats, stations: Floats) -> Surface:
    """Return an outline (n, 3) swept through stations (m, 3), with ends closed."""
    n, m = len(outline), len(stations)
    rings = (stations[:, None] + outline[None]).reshape(-1, 3)
    ring = np.arange(n)
    step = np.arange(m - 1)[:, None] * n
    a, b = (step + ring).ravel(), (step + (ring + 1) % n).ravel()
    sides = np.concatenate([np.stack([a, b, b + n], 1), np.stack([a, b + n, a + n], 1)])
    # Ends have corners of their own: shading must not run round their edges.
    fan = np.stack([np.zeros(n - 2, dtype=int), ring[1:-1], ring[2:]], 1)
    first, last = n * m, n * m + n
    ends = np.concatenate([first + fan[:, ::-1], last + fan])
    return Surface(np.concatenate([rings, rings[:n], rings[-n:]]), np.concatenate([sides, ends]))


def circle(radius: float) -> Floats:
    """Return a circle in the y-z plane, anticlockwise seen from +x."""
    angle = 2 * np.pi * np.arange(ROUND) / ROUND
    return radius * np.stack([np.zeros(ROUND), np.cos(angle), np.sin(angle)], axis=1)


def rod(start: Floats, end: Floats, radius: float) -> Surface:
    """Return a round rod between two places."""
    along = np.asarray(end, dtype=float) - np.asarray(start, dtype=float)
    length = float(np.linalg.norm(along))
    straight = swept(circle(radius), np.array([[0.0, 0, 0], [length, 0, 0]]))
    return straight.moved(_towards(along), start)


def cone(start: Floats, end: Floats, radius: float) -> Surface:
    """Return a cone that ends in a point."""
    along = np.asarray(end, dtype=float) - np.asarray(start, dtype=float)
    ring = circle(radius)
    corners = np.concatenate([ring, ring, [[np.linalg.norm(along), 0, 0]]])
    i = np.arange(ROUND)
    sides = np.stack([i, (i + 1) % ROUND, np.full(ROUND, 2 * ROUND)], axis=1)
    foot = ROUND + np.stack([np.zeros(ROUND - 2, dtype=int), i[2:], i[1:-1]], axis=1)
    return Surface(corners, np.concatenate([sides, foot])).moved(_towards(along), start)


def arrow(start: Floats, end: Floats, radius: float) -> Surface:
    """Return an arrow whose head takes a third of it at most."""
    start, end = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    length = float(np.linalg.norm(end - start))
    neck = end - (end - start) * min(6 * radius / length, 1 / 3)
    return joined(rod(start, neck, radius), cone(neck, end, 2.5 * radius))


def box(size: Floats, centre: Floats | tuple[float, ...] = (0.0, 0.0, 0.0)) -> Surface:
    """Return a box of three edges, with flat faces."""
    faces: list[Ints] = []
    corners: list[Floats] = []
    for axis in range(3):
        for side in (-1, 1):
            u, v = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3]
            square = side * np.eye(3)[axis] + np.array([-u - v, u - v, u + v, v - u])
            faces.append(np.array([[0, 1, 2], [0, 2, 3]])[:, ::side] + 4 * len(corners))
            corners.append(square)
    found = 0.5 * np.asarray(size) * np.concatenate(corners) + np.asarray(centre)
    return Surface(found, np.concatenate(faces))


def ball(radius: float) -> Surface:
    """Return a sphere."""
    n, m = ROUND, ROUND // 2
    polar = np.pi * np.arange(m + 1) / m
    around = 2 * np.pi * np.arange(n) / n
    rings = np.stack(
        [
            np.outer(np.sin(polar), np.cos(around)),
            np.outer(np.sin(polar), np.sin(around)),
            np.outer(np.cos(polar), np.ones(n)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    i, j = (grid.ravel() for grid in np.meshgrid(np.arange(m), np.arange(n), indexing="ij"))
    a, b = i * n + j, i * n + (j + 1) % n
    faces = np.concatenate([np.stack([a, a + n, b + n], 1), np.stack([a, b + n, b], 1)])
    return Surface(radius * rings, faces)


def triangles(faces: list[tuple[int, ...]]) -> Ints:
    """Return polygons as triangles."""
    return np.array([(f[0], f[i], f[i + 1]) for f in faces for i in range(1, len(f) - 1)], dtype=int)


# ----------------------------------------------------------------------------------------------------- beams


def beam_skin(link: Beam, bones: list[int], colour: str) -> Skin:
    """Return a beam along its bones, with its section.

    A general section is drawn as the round bar or the rectangle of its area and second moments.
    """
    in_link = np.array(from_axes(link.end, link.lean))  # the section's axes: x along the beam, z towards `up`
    outline = _outline(link.section) @ in_link.T
    along = swept(outline, np.zeros((len(bones), 3)))
    per_ring = len(outline)
    ring = np.repeat(bones, per_ring)
    bone = np.concatenate([ring, np.full(per_ring, bones[0]), np.full(per_ring, bones[-1])])
    return Skin("beams", link.name, bone[:, None], along.corners[:, None], along.faces, colour)


def half_widths(section: Section) -> tuple[float, float]:
    """Return half the width along y and half the height along z of a section [m]."""
    if isinstance(section, Tube):
        return (section.outer_diameter / 2,) * 2
    if isinstance(section, Round):
        return (section.diameter / 2,) * 2
    if isinstance(section, Rectangle):
        return section.width / 2, section.height / 2
    inertia_y, inertia_z = section.second_moments
    if not _is_round(section):  # I_y = A h^2/12
        return float(np.sqrt(3 * inertia_z / section.area)), float(np.sqrt(3 * inertia_y / section.area))
    # A = pi (r^2 - i^2) and I = A (r^2 + i^2)/4 of a tube with radii r and i
    return (float(np.sqrt(2 * inertia_y / section.area + section.area / (2 * np.pi))),) * 2


def _is_round(section: General) -> bool:
    inertia_y, inertia_z = section.second_moments
    return bool(np.isclose(inertia_y, inertia_z))


def _outline(section: Section) -> Floats:
    width, height = half_widths(section)
    if isinstance(section, Rectangle) or (isinstance(section, General) and not _is_round(section)):
        y, z = np.array([1, -1, -1, 1]) * width, np.array([1, 1, -1, -1]) * height
        # each edge has corners of its own, which keeps it sharp
        y, z = np.repeat(y, 2), np.repeat(z, 2)
        return np.stack([np.zeros(8), y, z], axis=1)
    return circle(width)


# ---------------------------------------------------------------------------------------- super-elements


def hung(
    surface: Surface,
    bones: list[int],
    positions: Floats,
    rotations: Floats,
    layer: str,
    name: str,
    colour: str,
) -> Skin:
    """Return a mesh in the frame of its part on its interfaces, eq. (1), which stand there at these poses."""
    away = surface.corners[:, None] - positions
    place = np.einsum("kji,vkj->vki", rotations, away)
    squares = np.sum(away**2, axis=-1)
    weight = 1 / np.maximum(squares, 1e-12 * max(float(squares.max()), np.finfo(float).tiny))
    weight /= weight.sum(axis=1, keepdims=True)
    bone = np.broadcast_to(np.array(bones), weight.shape)
    return Skin(layer, name, bone, place, surface.faces, colour, weight)


def _towards(direction: Floats) -> Floats:
    """Return a rotation that turns x into a direction."""
    x = np.asarray(direction, dtype=float)
    least = np.eye(3)[int(np.argmin(np.abs(x)))]
    return np.array(from_axes(tuple(map(float, x)), tuple(map(float, least))))  # type: ignore[arg-type]
