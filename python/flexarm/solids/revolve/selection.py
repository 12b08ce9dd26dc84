"""Sets of points by place: faces of blocks, patches, pads of bolts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from flexarm.arrays import Floats, Ints
from flexarm.errors import InvalidParameter
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
    points: Floats, blocks: Sequence[Block], patches: Sequence[Patch | BoltCircle]
) -> dict[str, Ints]:
    """Return every set by its name: faces of the part, faces of its blocks, patches, pads."""
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
        sets |= dict(_pads(places, patch) if isinstance(patch, BoltCircle) else _patch(places, patch))
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


def _pads(places: _Places, bolts: BoltCircle) -> Iterator[tuple[str, Ints]]:
    half = bolts.diameter / 2
    ring = places.within(bolts.radius - half, bolts.radius + half, bolts.height, bolts.height)
    pads = []
    for k in range(bolts.count):
        centre = bolts.phase + 2 * np.pi * k / bolts.count
        away = np.angle(np.exp(1j * (places.angle[ring] - centre)))
        pad = ring[np.abs(away) * bolts.radius <= half * (1 + 1e-9)]
        if len(np.unique(np.round(away[np.isin(ring, pad)], 9))) < 2:
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
