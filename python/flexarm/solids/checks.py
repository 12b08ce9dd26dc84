"""Defects that spoil a computation with a mesh, and values that are allowed and yet look wrong.

A cell is inverted or flat where det J <= 0 at a point of integration: the stiffness would be infinite or of
the wrong sign. Points that coincide without being one leave a crack; pieces that share no point are several
parts.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from flexarm import _core
from flexarm.arrays import Ints
from flexarm.errors import Problem
from flexarm.solids.assigned import material_problems
from flexarm.solids.cell_types import ALLOWED
from flexarm.solids.core import smallest_jacobians
from flexarm.solids.shape import coincident, components, shortest_edge, used_points
from flexarm.tables.ranges import range_of

if TYPE_CHECKING:
    from flexarm.solids.mesh import SolidMesh

#: Points closer than this part of the shortest edge are taken for one point written twice.
COINCIDENT = 1e-3
#: Below this part of an ideal cell's, det J counts as zero: the cell is flat.
FLAT = 1e-6
_SHOWN = 10
#: Where cells with middle nodes are inverted, a curved surface is often why.
_CURVED = dict.fromkeys(
    ("tet10", "hex20"),
    "; if their middle nodes follow a curved surface, let the mesher optimise them (Gmsh: "
    "Mesh.HighOrderOptimize = 2), keep them straight (Mesh.SecondOrderLinear = 1) or mesh finer",
)


def problems(mesh: SolidMesh) -> Iterator[Problem]:
    """Yield everything that is wrong, the cause before its consequences."""
    if not mesh.cells:
        yield Problem("cells", f"there are no solid cells; needed are {ALLOWED}")
        return
    most = range_of("m")[1]
    infinite = np.flatnonzero(~(np.abs(mesh.points) <= most).all(axis=1))
    if len(infinite):
        what = f"coordinates must be finite and within +-{most:g} m"
        yield Problem("points", f"{what}; they are not at {_points(mesh, infinite)}")
        return
    repeated = list(_repeated(mesh))
    yield from repeated
    if not repeated:
        yield from _inverted(mesh)
    yield from _twice(mesh)
    yield from _duplicates(mesh)
    yield from _loose(mesh)
    left = np.flatnonzero(~used_points(mesh.cells.values(), mesh.n_points))
    if len(left):
        yield Problem("points", f"{len(left)} nodes belong to no cell: {_points(mesh, left)}")
    yield from material_problems(mesh)


def _inverted(mesh: SolidMesh) -> Iterator[Problem]:
    for kind, values in smallest_jacobians(mesh).items():
        flat, inverted = np.flatnonzero(np.abs(values) <= FLAT), np.flatnonzero(values < -FLAT)
        if len(inverted):
            whole = len(inverted) == len(values)
            hint = "; as all are, their nodes are in another order" if whole else _CURVED.get(kind, "")
            yield Problem(
                f"cells.{kind}",
                f"{len(inverted)} of {len(values)} cells are inverted (negative volume): "
                f"{_cells(mesh, kind, inverted)}{hint}",
            )
        if len(flat):
            what = f"{len(flat)} of {len(values)} cells have no volume: {_cells(mesh, kind, flat)}"
            yield Problem(f"cells.{kind}", what)


def _repeated(mesh: SolidMesh) -> Iterator[Problem]:
    for kind, nodes in mesh.cells.items():
        ordered = np.sort(nodes, axis=1)
        bad = np.flatnonzero((ordered[:, 1:] == ordered[:, :-1]).any(axis=1))
        if len(bad):
            yield Problem(
                f"cells.{kind}",
                f"{len(bad)} of {len(nodes)} cells name a node twice (collapsed to a wedge or less): "
                f"{_cells(mesh, kind, bad)}; mesh with {ALLOWED} that have all their nodes",
            )


def _twice(mesh: SolidMesh) -> Iterator[Problem]:
    for kind, nodes in mesh.cells.items():
        _, first = np.unique(np.sort(nodes, axis=1), axis=0, return_index=True)
        if len(first) < len(nodes):
            again = np.setdiff1d(np.arange(len(nodes)), first)
            yield Problem(
                f"cells.{kind}",
                f"{len(again)} of {len(nodes)} cells have the nodes of another: {_cells(mesh, kind, again)}; "
                "their mass and stiffness would count twice: write each cell once",
            )


def _duplicates(mesh: SolidMesh) -> Iterator[Problem]:
    tolerance = COINCIDENT * shortest_edge(mesh)
    pairs = coincident(mesh.points, tolerance) if np.isfinite(tolerance) else np.empty((0, 2), int)
    if len(pairs):
        numbers = mesh.point_numbers
        assert numbers is not None  # __post_init__ sets it
        power = 10.0 ** np.floor(np.log10(tolerance))
        above = np.ceil(tolerance / power) * power  # of one digit
        shown = ", ".join(f"{numbers[a]} and {numbers[b]}" for a, b in pairs[:_SHOWN])
        yield Problem(
            "points",
            f"{len(pairs)} pairs of nodes lie in one place ({shown}{_more(len(pairs))}): the part has "
            f"cracks; make them one: merge = {above:g} [m] when reading, or in the mesher",
        )


def _loose(mesh: SolidMesh) -> Iterator[Problem]:
    _, labels = components(mesh)
    used = used_points(mesh.cells.values(), mesh.n_points)
    labels = np.where(used, labels, -1)
    pieces, sizes = np.unique(labels[used], return_counts=True)
    if len(pieces) < 2:
        return
    order = np.argsort(-sizes, kind="stable")
    firsts = [np.flatnonzero(labels == pieces[i])[0] for i in order[:_SHOWN]]
    shown = "; ".join(
        f"{sizes[i]} nodes around {_points(mesh, np.array([first]))}"
        for i, first in zip(order, firsts, strict=False)
    )
    yield Problem(
        "cells",
        f"the mesh falls into {len(pieces)} pieces that share no node: {shown}{_more(len(pieces))}; "
        "a part must hang together: merge coincident nodes, or give each piece a file of its own",
    )


def _cells(mesh: SolidMesh, kind: str, which: Ints) -> str:
    """Return the numbers of cells in the file, and where the first is."""
    numbers = mesh.cell_numbers[kind][which[:_SHOWN]]
    middle = mesh.points[mesh.cells[kind][which[0]]].mean(axis=0)
    place = ", ".join(f"{x:.4g}" for x in middle)
    return f"{', '.join(map(str, numbers))}{_more(len(which))} (the first near [{place}] m)"


def _points(mesh: SolidMesh, which: Ints) -> str:
    numbers = mesh.point_numbers
    assert numbers is not None  # __post_init__ sets it
    place = ", ".join(f"{x:.4g}" for x in mesh.points[which[0]])
    return f"node {', '.join(map(str, numbers[which[:_SHOWN]]))}{_more(len(which))} at [{place}] m"


def _more(count: int) -> str:
    return f" and {count - _SHOWN} more" if count > _SHOWN else ""


#: A part beyond these sizes [m] is no robot's: it was probably drawn in millimetres, or taken for it.
LARGEST, SMALLEST = 50.0, 1e-4


def validate(mesh: SolidMesh) -> Iterator[Problem]:
    """Yield all plausibility problems of a mesh."""
    yield from _size(mesh)
    yield from _materials(mesh)
    empty = [name for name, points in mesh.point_sets.items() if not len(points)]
    if empty:
        yield Problem("point sets", f"without points of solid cells: {', '.join(empty)}")
    yield from _distorted(mesh)


def refuse_implausible(mesh: SolidMesh) -> None:
    """Refuse a part whose size or mass no part of an arm has: a unit was left out.

    Raise InvalidParameter with size and mass, and how to insist.
    """
    heaviest = 1e5  # [kg]: booms of the largest excavators have some tens of tonnes
    size = float((mesh.box[1] - mesh.box[0]).max())
    mass = float(_core.mass_properties(mesh.core())[0])
    if SMALLEST <= size <= LARGEST and mass <= heaviest:
        return
    unit = "m" if size < SMALLEST else "mm"
    raise mesh.error(
        "unit",
        f"the part is {size:.4g} m across and weighs {mass:.4g} kg; allowed are {SMALLEST:g} to "
        f"{LARGEST:g} m, {heaviest:g} kg. Say --unit {unit} (unit = {unit!r}), or "
        "state with --mass what it weighs",
    )


def _size(mesh: SolidMesh) -> Iterator[Problem]:
    if not mesh.n_points:
        return
    size = float((mesh.box[1] - mesh.box[0]).max())
    if size > LARGEST:
        yield Problem("unit", f"the part is {size:.4g} m across; did you mean unit = 'mm'?")
    elif size < SMALLEST:
        yield Problem("unit", f"the part is {size:.4g} m across; did you mean unit = 'm'?")


def _materials(mesh: SolidMesh) -> Iterator[Problem]:
    for name, material in mesh.materials.items():
        if material.youngs_modulus < 1e6:
            yield Problem(
                f"materials.{name}",
                f"E is {material.youngs_modulus:g} Pa, softer than rubber; moduli are in Pa (steel 210e9); "
                "unit = 'mm' converts those of files in MPa",
            )
        if not 50 < material.density < 25e3:
            yield Problem(
                f"materials.{name}",
                f"density is {material.density:g} kg/m3; densities are in kg/m3 (steel 7850); unit = 'mm' "
                "converts those of files in t/mm3",
            )


def _distorted(mesh: SolidMesh) -> Iterator[Problem]:
    distorted = 0.05
    for kind, values in smallest_jacobians(mesh).items():
        bad = np.flatnonzero((values > FLAT) & (values < distorted))
        if len(bad):
            worst = bad[values[bad].argmin()]
            yield Problem(
                f"cells.{kind}",
                f"{len(bad)} of {len(values)} cells are badly distorted (det J below {distorted} of an ideal "
                f"cell's); the worst is cell {mesh.cell_numbers[kind][worst]} with {values[worst]:.2g}",
            )
