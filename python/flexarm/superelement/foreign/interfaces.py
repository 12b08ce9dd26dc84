r"""Interfaces out of points: single points with six freedoms, or several points tied to a frame.

A point at p follows the frame at p_0 with displacement t and rotation w rigidly:

.. math:: u = t + w \times (p - p_0), \quad \theta = w                                               (1)

Freedoms stand along the axes A of their point, so u_A = A^T u. The reduction Q of all foreign freedoms to
those of the interfaces and modes collects (1) row by row, and every matrix becomes Q^T X Q. Tying points of
solids, which have no rotations, makes an interface of them; a single point with six freedoms is only turned
into the part's axes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter
from flexarm.superelement.foreign.grids import Grid
from flexarm.superelement.foreign.labelled import SCALAR, Freedom
from flexarm.superelement.rigid_motion import PER_INTERFACE, cross_matrix

ALL = frozenset(range(1, 7))


@dataclass(frozen=True, eq=False)
class Reduction:
    """Interfaces and the matrix Q that reduces the foreign freedoms to theirs and to the modes."""

    names: tuple[str, ...]
    positions: Floats
    rotations: Floats
    Q: Floats


def reduction(
    freedoms: Sequence[Freedom], grids: Mapping[int, Grid], wanted: Mapping[str, Sequence[int]]
) -> Reduction:
    """Return the interfaces of a foreign matrix with these freedoms, in its order.

    `grids` are points by number, positions in m, and `wanted` the points of each interface; points that are
    left out and have six freedoms become interfaces `grid_NUMBER`.

    Raise InvalidParameter if a point is not defined, in two interfaces, or has too few freedoms to be one by
    itself.
    """
    held: dict[int, set[int]] = {}
    for freedom in freedoms:
        if freedom.component != SCALAR:
            held.setdefault(freedom.point, set()).add(freedom.component)
    groups = _groups(held, grids, wanted)
    n_modes = sum(freedom.component == SCALAR for freedom in freedoms)
    positions = np.array([np.mean([grids[p].position for p in points], axis=0) for points in groups.values()])
    rotations = np.array([grids[p[0]].axes if len(p) == 1 else np.eye(3) for p in groups.values()])
    Q = np.zeros((len(freedoms), PER_INTERFACE * len(groups) + n_modes))
    place = {p: i for i, points in enumerate(groups.values()) for p in points}
    mode = PER_INTERFACE * len(groups)
    for row, freedom in enumerate(freedoms):
        if freedom.component == SCALAR:
            Q[row, mode] = 1
            mode += 1
            continue
        grid, i = grids[freedom.point], place[freedom.point]
        columns = slice(PER_INTERFACE * i, PER_INTERFACE * (i + 1))
        follows = np.zeros((6, 6))  # of a point for its frame, eq. (1)
        follows[:3, :3] = follows[3:, 3:] = grid.axes.T
        follows[:3, 3:] = -grid.axes.T @ cross_matrix(grid.position - positions[i])
        Q[row, columns] = follows[freedom.component - 1]
    return Reduction(tuple(groups), positions, rotations, Q)


def _groups(
    held: Mapping[int, set[int]], grids: Mapping[int, Grid], wanted: Mapping[str, Sequence[int]]
) -> dict[str, list[int]]:
    """Return the points of each interface, those that were named first."""
    groups: dict[str, list[int]] = {}
    taken: dict[int, str] = {}
    for name, points in wanted.items():
        for point in points:
            if point not in held:
                known = _few(sorted(held))
                what = f"the matrix has no point {point}; it has {known}"
                raise InvalidParameter(what, where=f"interface {name!r}")
            if point in taken:
                what = f"point {point} belongs to {taken[point]!r} already"
                raise InvalidParameter(what, where=f"interface {name!r}")
            taken[point] = name
        groups[name] = list(points)
    for point in held:
        if point not in taken:
            groups[f"grid_{point}"] = [point]
    for points in groups.values():
        _refuse_incomplete(points, held, grids)
    return groups


def _refuse_incomplete(points: list[int], held: Mapping[int, set[int]], grids: Mapping[int, Grid]) -> None:
    for point in points:
        if point not in grids:
            what = f"point {point} of the matrix is not among the {len(grids)} points of the grids' file"
            raise InvalidParameter(what, where="grids")
    if len(points) == 1 and held[points[0]] != ALL:
        (point,) = points
        has = ", ".join(map(str, sorted(held[point])))
        raise InvalidParameter(
            f"point {point} has the components {has} only, an interface needs all six: leave it out of the "
            "reduction (matrices of a whole mesh are not reduced here; give that mesh), or tie it with "
            "others, not in a line, to one interface: NAME=POINT,POINT,POINT",
            where="interfaces",
        )


def _few(points: Sequence[int]) -> str:
    return ", ".join(map(str, points[:8])) + (f" and {len(points) - 8} more" if len(points) > 8 else "")
