"""Interfaces as a user states them: a set of points, how it is tied, and where its frame stands.

A *rigid* interface is a frame that all points of its set follow: a flange bolted to something much stiffer.
An *average* one follows the points, in the least-squares sense, and leaves them free to deform: a flange
bolted to something much softer. The truth lies between the two.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexarm import _core
from flexarm.arguments import TEXT, takes
from flexarm.arrays import Floats, Ints
from flexarm.errors import InvalidParameter

if TYPE_CHECKING:
    from flexarm.solids import SolidMesh

Kind = Literal["rigid", "average"]
KINDS: tuple[str, ...] = get_args(Kind)


@dataclass(frozen=True, eq=False)
class InterfaceSet:
    """The points at which a part is joined.

    Parameters
    ----------
    points : str or array of int
        Name of a point set of the mesh, or indices of points.
    kind : {"rigid", "average"}
        "rigid": the points follow the frame. "average": the frame follows the points.
    position : (3,), optional
        Where the frame stands in the part's frame [m]; if left out, the centre of the faces that the points
        span, or the mean of the points where they span none.
    rotation : (3, 3), optional
        Its axes as columns; the part's if left out.
    """

    points: str | ArrayLike
    kind: Kind = "rigid"
    position: ArrayLike | None = None
    rotation: ArrayLike | None = None

    @classmethod
    @takes(text=TEXT)
    def from_text(cls, text: str) -> InterfaceSet:
        """Read `SET`, `SET:rigid` or `SET:average`.

        >>> InterfaceSet.from_text("flange:average").kind
        'average'
        """
        name, colon, kind = text.rpartition(":")
        if colon and kind in KINDS:
            return cls(name, kind)  # type: ignore[arg-type]
        return cls(text)

    def core(self, name: str, mesh: SolidMesh) -> Any:
        """Return the interface as the solver takes it.

        Raises
        ------
        InvalidParameter
            If the kind is unknown, or the set does not exist or is empty.
        """
        core: Any = _core
        if self.kind not in KINDS:
            what = f"must be one of {', '.join(KINDS)}, got {self.kind!r}"
            raise InvalidParameter(what, where=f"interface {name!r}")
        points = np.asarray(self._indices(mesh), dtype=np.int32)
        rotation = np.eye(3) if self.rotation is None else np.asarray(self.rotation, dtype=float)
        position = self.at(mesh)
        for what, array, shape in (("position", position, (3,)), ("rotation", rotation, (3, 3))):
            if array.shape != shape:
                raise InvalidParameter(
                    f"{what} must have the shape {shape}, got {array.shape}", where=f"interface {name!r}"
                )
        kind = getattr(core.InterfaceKind, self.kind)
        return core.Interface(name, position, rotation, points, kind, self._weights(mesh))

    def at(self, mesh: SolidMesh) -> Floats:
        """Return the position of the frame [m]."""
        if self.position is not None:
            return np.asarray(self.position, dtype=float)
        return np.average(mesh.points[self._indices(mesh)], axis=0, weights=self._weights(mesh))

    def size(self, mesh: SolidMesh) -> int:
        """Return the number of its points."""
        return len(self._indices(mesh))

    def _indices(self, mesh: SolidMesh) -> Ints:
        if not isinstance(self.points, str):
            return _as_indices(np.asarray(self.points), mesh.n_points)
        name, colon, kind = self.points.rpartition(":")
        if colon and self.points not in mesh.point_sets and name in mesh.point_sets:
            what = f"must be SET, {' or '.join(f'SET:{known}' for known in KINDS)}, got {self.points!r}"
            raise InvalidParameter(what, where=f"tie {kind!r} of point set {name!r}")
        return mesh.point_set(self.points)

    def _weights(self, mesh: SolidMesh) -> Floats:
        """Return weights in proportion to the outer areas that the points span, or else equal ones."""
        from flexarm.solids.point_areas import point_areas

        areas = point_areas(mesh, self._indices(mesh))
        return areas if areas.any() else np.ones(len(areas))


def _as_indices(points: NDArray[Any], n_points: int) -> Ints:
    """Return indices of points, given as indices or as a mask of all of them.

    Raise InvalidParameter if they are neither.
    """
    if points.dtype == bool and points.shape == (n_points,):
        return np.flatnonzero(points)
    fine = points.ndim == 1 and points.size > 0 and np.issubdtype(points.dtype, np.integer)
    if not fine or points.min() < 0 or points.max() >= n_points:
        raise InvalidParameter(
            f"must be the name of a set, indices 0 to {n_points - 1}, or a mask of all points; got an array "
            f"of {points.dtype}, shape {points.shape}"
            + (f", {points.min()} to {points.max()}" if fine else ""),
            where="points of an interface",
        )
    return points


def refuse_shared(sets: Mapping[str, InterfaceSet], mesh: SolidMesh) -> None:
    """Refuse points of two rigid interfaces, which cannot follow both frames.

    Raise InvalidParameter if rigid interfaces share points.
    """
    rigid = {name: item._indices(mesh) for name, item in sets.items() if item.kind == "rigid"}
    for (one, points), (other, others) in combinations(rigid.items(), 2):
        shared = np.intersect1d(points, others)
        if not len(shared):
            continue
        numbers = mesh.point_numbers
        assert numbers is not None  # __post_init__ sets it
        few = ", ".join(map(str, numbers[shared[:5]])) + (", .." if len(shared) > 5 else "")
        what = (
            f"shares {len(shared)} points with {one!r} (node {few}); a point may follow one rigid interface "
            "only: take them out of one set"
        )
        raise mesh.error(f"interface {other!r}", what)
