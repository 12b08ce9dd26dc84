"""Points made one, and meshes made one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Ints
from flexarm.errors import InvalidParameter, Problem
from flexarm.solids.shape import coincident, connected

if TYPE_CHECKING:
    from flexarm.solids.mesh import CellGroup, SolidMesh


def merge_points(mesh: SolidMesh, tolerance: float) -> SolidMesh:
    """Merge points at most `tolerance` [m] apart into the first of them."""
    if not tolerance > 0:
        raise InvalidParameter(f"must be positive, got {tolerance:g} m", where="merge")
    if not np.isfinite(mesh.points).all():
        return mesh  # the check says so
    pairs = coincident(mesh.points, tolerance)
    if not len(pairs):
        return mesh
    n = mesh.n_points
    _, label = connected(pairs[:, 0], pairs[:, 1], n)
    _, first = np.unique(label, return_index=True)
    keep = np.sort(first)
    new = np.empty(n, dtype=np.int32)
    new[keep] = np.arange(len(keep), dtype=np.int32)
    new = new[first[label]]
    note = Problem(
        "points", f"{n - len(keep)} of {n} nodes were made one with another within {tolerance:g} m"
    )
    assert mesh.point_numbers is not None  # __post_init__ sets it
    return replace(
        mesh,
        points=mesh.points[keep],
        cells={kind: new[nodes] for kind, nodes in mesh.cells.items()},
        point_sets={name: np.unique(new[points]) for name, points in mesh.point_sets.items()},
        point_numbers=mesh.point_numbers[keep],
        notes=(*mesh.notes, note),
    )


def join(a: SolidMesh, b: SolidMesh, tolerance: float) -> SolidMesh:
    """Join two meshes; groups and sets of the same name are united."""
    for name in a.materials.keys() & b.materials.keys():
        if a.materials[name] != b.materials[name]:
            raise InvalidParameter("has another material in each mesh; rename one", where=f"group {name!r}")
    count = {kind: len(nodes) for kind, nodes in a.cells.items()}
    cells = {
        kind: np.concatenate(
            [mesh.cells[kind] + shift for mesh, shift in ((a, 0), (b, a.n_points)) if kind in mesh.cells]
        )
        for kind in {**a.cells, **b.cells}
    }
    numbers = {
        kind: np.concatenate([mesh.cell_numbers[kind] for mesh in (a, b) if kind in mesh.cells])
        for kind in cells
    }
    assert a.point_numbers is not None and b.point_numbers is not None  # __post_init__ sets them
    joined = replace(
        a,
        points=np.concatenate([a.points, b.points]),
        cells=cells,
        cell_groups=_united(a.cell_groups, b.cell_groups, count),
        point_sets={
            name: _both(a.point_sets.get(name), b.point_sets.get(name), a.n_points)
            for name in {**a.point_sets, **b.point_sets}
        },
        materials={**a.materials, **b.materials},
        file=" and ".join(file for file in (a.file, b.file) if file),
        cell_numbers=numbers,
        point_numbers=np.concatenate([a.point_numbers, b.point_numbers]),
        notes=(*a.notes, *b.notes),
    )
    return merge_points(joined, tolerance) if tolerance else joined


def _united(
    a: Mapping[str, CellGroup], b: Mapping[str, CellGroup], count: Mapping[str, int]
) -> dict[str, dict[str, Ints]]:
    return {
        name: {
            kind: _both(a.get(name, {}).get(kind), b.get(name, {}).get(kind), count.get(kind, 0))
            for kind in {**a.get(name, {}), **b.get(name, {})}
        }
        for name in {**a, **b}
    }


def _both(a: Ints | None, b: Ints | None, shift: int) -> Ints:
    empty = np.empty(0, dtype=np.int32)
    return np.concatenate([empty if a is None else a, empty if b is None else b + np.int32(shift)])
