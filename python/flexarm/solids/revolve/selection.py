"""Sets of points by place: faces of blocks, patches, pads of bolts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from flexarm.arrays import Floats, Ints
from flexarm.errors import InvalidParameter, Problem
from flexarm.solids.revolve.lines import SAME
from flexarm.solids.revolve.profile import Block, BoltCircle, Patch


class _Places:
    """Points by radius, height and angle, with room for rounding."""

    def __init__(self, points: Floats) -> None:
        self.r = np.hypot(points[:, 0], points[:, 1])
        self.z = points[:, 2]
        self.angle = np.arctan2(points[:, 1], points[:, 0])
        self.room = 2 * SAME * max(float(self.r.max()), float(np.ptp(self.z)))

    def within(self, inner: float, outer: float, bottom: float, top: float) -> Ints:
        near = self.room
        wide = (self.r >= inner - near) & (self.r <= outer + near)
        return np.flatnonzero(wide & (self.z >= bottom - near) & (self.z <= top + near))


def point_sets(
    points: Floats, blocks: Sequence[Block], patches: Sequence[Patch | BoltCircle], around: int
) -> dict[str, Ints]:
    """Return every set by its name: faces of the part, faces of its blocks, patches, pads.

    `around` is the number of cells around the axis.
    """
    places = _Places(points)
    whole = Patch(
        "",
        inner=min(b.inner for b in blocks),
        outer=max(b.outer for b in blocks),
        bottom=min(b.bottom for b in blocks),
        top=max(b.top for b in blocks),
    )
    sets = dict(_faces(places, whole, ""))
    for block in blocks:
        sets |= dict(_faces(places, block, f"{block.name}."))
    for patch in patches:
        sets |= dict(_pads(places, patch, around) if isinstance(patch, BoltCircle) else _patch(places, patch))
    return sets


def _faces(places: _Places, of: Block | Patch, prefix: str) -> Iterator[tuple[str, Ints]]:
    if of.inner > 0:
        yield prefix + "inner", places.within(of.inner, of.inner, of.bottom, of.top)
    yield prefix + "outer", places.within(of.outer, of.outer, of.bottom, of.top)
    yield prefix + "bottom", places.within(of.inner, of.outer, of.bottom, of.bottom)
    yield prefix + "top", places.within(of.inner, of.outer, of.top, of.top)


def _patch(places: _Places, patch: Patch) -> Iterator[tuple[str, Ints]]:
    found = places.within(patch.inner, patch.outer, patch.bottom, patch.top)
    if not len(found):
        raise InvalidParameter(
            f"there is no material between radii {patch.inner:g} and {patch.outer:g} m, heights "
            f"{patch.bottom:g} and {patch.top:g} m",
            where=f"patch {patch.name!r}",
        )
    yield patch.name, found


def pad_notes(patches: Sequence[Patch | BoltCircle], around: int) -> list[Problem]:
    """Return a note on each bolt circle whose pads the mesh makes wider or narrower by a tenth."""
    notes = []
    for bolts in patches:
        if isinstance(bolts, BoltCircle):
            lines = [last - first for first, last in (_sides(bolts, k, around) for k in range(bolts.count))]
            widths = 2 * np.pi / around * bolts.radius * np.array(lines)
            worst = widths[np.argmax(np.abs(widths - bolts.diameter))]
            if abs(worst / bolts.diameter - 1) > 0.1:
                what = f"pads are {worst:.3g} m wide along the circle, not {bolts.diameter:g} m"
                where = f"bolt circle {bolts.name!r}"
                notes.append(Problem(where, f"{what}: they are whole cells; give more around the axis"))
    return notes


def _sides(bolts: BoltCircle, k: int, around: int) -> tuple[int, int]:
    """Return the lines of the mesh nearest to the sides of a pad, of two as near the outer one."""
    centre = around * (bolts.phase / (2 * np.pi) + k / bolts.count)
    reach = around * bolts.diameter / (4 * np.pi * bolts.radius) + 0.5 + SAME
    return int(np.ceil(centre - reach)), int(np.floor(centre + reach))


def _pads(places: _Places, bolts: BoltCircle, around: int) -> Iterator[tuple[str, Ints]]:
    half, step = bolts.diameter / 2, 2 * np.pi / around
    ring = places.within(bolts.radius - half, bolts.radius + half, bolts.height, bolts.height)
    pads = []
    for k in range(bolts.count):
        centre = bolts.phase + 2 * np.pi * k / bolts.count
        first, last = _sides(bolts, k, around)
        away = np.angle(np.exp(1j * (places.angle[ring] - (first + last) / 2 * step)))
        pad = ring[np.abs(away) <= ((last - first) / 2 + SAME) * step]
        if last <= first or not len(pad):
            raise InvalidParameter(
                f"the pad at {np.degrees(centre):g} degrees holds {len(pad)} points, not an area; give "
                f"at least {int(np.ceil(4 * np.pi * bolts.radius / bolts.diameter))} cells around the axis, "
                "larger pads or a face that is there",
                where=f"bolt circle {bolts.name!r}",
            )
        pads.append(pad)
    yield bolts.name, np.unique(np.concatenate(pads))
    for k, pad in enumerate(pads, start=1):
        yield f"{bolts.name}-{k}", pad
