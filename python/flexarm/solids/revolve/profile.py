"""The parts of a profile in the (r, z) half-plane: blocks of material, patches of surface, bolt circles.

All are rectangles with sides along r and z: `inner` and `outer` are radii, `bottom` and `top` heights along
the axis z [m].
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

from flexarm.errors import InvalidParameter
from flexarm.material import Material


@dataclass(frozen=True)
class Block:
    """A ring of material: inner <= r <= outer, bottom <= z <= top. `inner = 0` is a solid disc."""

    name: str
    """Name of its group of cells, and of the sets `NAME.inner`, `NAME.outer`, `NAME.bottom`, `NAME.top` of
    the points on its four faces (three for a solid disc)."""
    inner: float
    outer: float
    """Radii [m]."""
    bottom: float
    top: float
    """Heights [m]."""
    material: Material | None = None
    """Of its cells."""

    def __post_init__(self) -> None:
        _check(f"block {self.name!r}", self.inner, self.outer, self.bottom, self.top)
        if self.inner == self.outer or self.bottom == self.top:
            raise InvalidParameter(
                f"has no volume: radii {self.inner:g} to {self.outer:g} m, heights {self.bottom:g} to "
                f"{self.top:g} m",
                where=f"block {self.name!r}",
            )


@dataclass(frozen=True)
class Patch:
    """A place of the part to give a name: all points with inner <= r <= outer and bottom <= z <= top.

    With `inner = outer` it is a band on a cylinder (a bearing seat), with `bottom = top` a ring on a face.
    The mesh gets lines along its sides, so that it begins and ends exactly there.
    """

    name: str
    """Name of the set of points."""
    inner: float
    outer: float
    """Radii [m]."""
    bottom: float
    top: float
    """Heights [m]."""

    def __post_init__(self) -> None:
        _check(f"patch {self.name!r}", self.inner, self.outer, self.bottom, self.top)


@dataclass(frozen=True)
class BoltCircle:
    """Pads under the heads of bolts, evenly spaced on a face.

    Each pad is the sector of a ring that is as wide along r, and along the circle, as `diameter`; along the
    circle it ends at the lines of the mesh nearest to its sides, so that it is made of whole faces. The set
    `NAME` holds the points of all pads, `NAME-1`, `NAME-2`, .. those of each.
    """

    name: str
    radius: float
    """Of the circle through the bolts [m]."""
    count: int
    diameter: float
    """Of a pad [m]."""
    height: float
    """z of the face that the pads are on [m]."""
    phase: float = 0.0
    """Angle of the first bolt from x [rad]."""

    def __post_init__(self) -> None:
        where = f"bolt circle {self.name!r}"
        if self.count < 1:
            raise InvalidParameter(f"needs at least one bolt, got count = {self.count}", where=where)
        if not 0 < self.diameter < 2 * self.radius:
            raise InvalidParameter(
                f"the pads' diameter must be positive and below the circle's ({2 * self.radius:g} m), "
                f"got {self.diameter:g} m",
                where=where,
            )


def _check(where: str, inner: float, outer: float, bottom: float, top: float) -> None:
    if not all(map(isfinite, (inner, outer, bottom, top))):
        raise InvalidParameter("radii and heights must be finite", where=where)
    if not 0 <= inner <= outer:
        what = f"radii must be 0 <= inner <= outer, got inner = {inner:g}, outer = {outer:g} m"
        raise InvalidParameter(what, where=where)
    if bottom > top:
        what = f"heights must be bottom <= top, got bottom = {bottom:g}, top = {top:g} m"
        raise InvalidParameter(what, where=where)
