"""The part that is in a file: solid cells, groups of them, sets of points, in SI.

Cells of lower dimension are no solids: a group of them (a physical surface, an element set of shells) becomes
the set of its points. Points that no solid cell uses are left out.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Ints
from flexarm.errors import InvalidFile, Problem
from flexarm.material import Material
from flexarm.solids.cell_types import ALLOWED, BY_MESHIO_NAME
from flexarm.solids.mesh import SolidMesh
from flexarm.solids.reading.content import Content
from flexarm.solids.reading.units import si_materials
from flexarm.solids.shape import used_points
from flexarm.units import factor_to

_FLAT = ("vertex", "line", "triangle", "quad", "polygon")
_REMEDY = {
    "wedge": "mesh with tetrahedra, or with hexahedra only",
    "pyramid": "mesh with tetrahedra, or with hexahedra only",
    "tetra": "use order 2 at most",
    "hexahedron": "use order 2 at most",
}


def part_in(content: Content, file: str, unit: str, materials: Mapping[str, Material]) -> SolidMesh:
    """Return the solid mesh in a file's content, given the file's name, its unit of length and materials.

    Materials by group, in SI, take the place of those in the file.
    """
    _refuse_other_solids(content, file)
    _refuse_missing_points(content, file)
    kinds = [BY_MESHIO_NAME[_lesser(b.kind)].name if _is_solid(b.kind) else "" for b in content.blocks]
    cells, numbers, offset = _cells(content, kinds)
    if not cells:
        there = ", ".join(f"{n} of type {kind}" for kind, n in _counts(content).items()) or "no cells at all"
        raise InvalidFile(file, "cells", f"there are no solid cells ({there}); needed are {ALLOWED}")
    used = used_points(cells.values(), len(content.points))
    new = np.cumsum(used) - 1
    groups, sets = _groups(content, kinds, offset)
    if content.repeats:
        cells, numbers, groups = _each_once(cells, numbers, groups)
    in_file = {name: m for name, m in content.materials.items() if name not in materials and name in groups}
    known, not_used = si_materials(in_file, unit)
    notes = [*content.notes, *_left_out(content, used), *not_used]
    return SolidMesh(
        points=content.points[used] * (factor_to("m", unit) or 1.0),
        cells={kind: new[nodes] for kind, nodes in cells.items()},
        cell_groups=groups,
        point_sets={name: np.unique(new[points[used[points]]]) for name, points in sets.items()},
        materials={**known, **materials},
        file=file,
        cell_numbers=numbers,
        point_numbers=content.numbers[used],
        notes=tuple(notes),
    )


def _is_solid(kind: str) -> bool:
    return not kind.startswith(_FLAT)


def _lesser(kind: str) -> str:
    """Read 27-node hexahedra as 20-node ones, whose nodes are their first 20."""
    return "hexahedron20" if kind == "hexahedron27" else kind


def _refuse_other_solids(content: Content, file: str) -> None:
    counts = {
        kind: n
        for kind, n in _counts(content).items()
        if _is_solid(kind) and _lesser(kind) not in BY_MESHIO_NAME
    }
    if counts:
        shown = ", ".join(f"{count} of type {kind}" for kind, count in counts.items())
        remedy = next((r for stem, r in _REMEDY.items() if next(iter(counts)).startswith(stem)), "")
        what = f"cells that flexarm has no element for: {shown}; allowed are {ALLOWED}; {remedy}"
        raise InvalidFile(file, "cells", what)


def _refuse_missing_points(content: Content, file: str) -> None:
    """Refuse indices of points that do not exist: a negative one would count from the end."""
    for block in content.blocks:
        wrong = ((block.nodes < 0) | (block.nodes >= len(content.points))).any(axis=1)
        if wrong.any():
            number = block.numbers[np.flatnonzero(wrong)[0]]
            raise InvalidFile(file, "cells", f"cell {number} names a node that is not in the file")


def _counts(content: Content) -> Counter[str]:
    """Count the cells of each type."""
    counts: Counter[str] = Counter()
    for block in content.blocks:
        counts[block.kind] += len(block.nodes)
    return counts


def _cells(content: Content, kinds: list[str]) -> tuple[dict[str, Ints], dict[str, Ints], list[int]]:
    """Return the cells and their numbers by type, and where in its type each block begins."""
    cells: dict[str, list[Ints]] = {}
    numbers: dict[str, list[Ints]] = {}
    offset, count = [], dict.fromkeys(kinds, 0)
    for block, kind in zip(content.blocks, kinds, strict=True):
        offset.append(count[kind])
        if not kind:
            continue
        count[kind] += len(block.nodes)
        cells.setdefault(kind, []).append(block.nodes[:, :20])
        numbers.setdefault(kind, []).append(block.numbers)
    return (
        {kind: np.concatenate(parts) for kind, parts in cells.items()},
        {kind: np.concatenate(parts) for kind, parts in numbers.items()},
        offset,
    )


def _groups(
    content: Content, kinds: list[str], offset: list[int]
) -> tuple[dict[str, dict[str, Ints]], dict[str, Ints]]:
    """Return groups of solid cells, and all sets of points."""
    groups: dict[str, dict[str, Ints]] = {}
    sets = dict(content.point_sets)
    for name, members in content.groups.items():
        solid: dict[str, list[Ints]] = {}
        flat: list[Ints] = []
        for i, cells in members.items():
            if not len(cells):
                continue
            if kinds[i]:
                solid.setdefault(kinds[i], []).append(cells + offset[i])
            else:
                flat.append(content.blocks[i].nodes[cells].ravel())
        if solid:
            groups[name] = {kind: np.unique(np.concatenate(parts)) for kind, parts in solid.items()}
        if flat:
            sets[name if name not in sets else f"{name}-cells"] = np.concatenate(flat)
    return groups, sets


def _each_once(
    cells: dict[str, Ints], numbers: dict[str, Ints], groups: dict[str, dict[str, Ints]]
) -> tuple[dict[str, Ints], dict[str, Ints], dict[str, dict[str, Ints]]]:
    """Merge cells that name the same nodes; the merged cell is in the groups of all."""
    kept, new = {}, {}
    for kind, nodes in cells.items():
        _, first, same = np.unique(np.sort(nodes, axis=1), axis=0, return_index=True, return_inverse=True)
        kept[kind] = np.sort(first)
        new[kind] = np.searchsorted(kept[kind], first[same.ravel()])
    return (
        {kind: nodes[kept[kind]] for kind, nodes in cells.items()},
        {kind: values[kept[kind]] for kind, values in numbers.items()},
        {
            name: {kind: np.unique(new[kind][members]) for kind, members in group.items()}
            for name, group in groups.items()
        },
    )


def _left_out(content: Content, used: NDArray[np.bool_]) -> list[Problem]:
    notes = []
    lost = [name for name, points in content.point_sets.items() if not used[points].all()]
    if lost:
        what = f"points of no solid cell were left out of {', '.join(lost[:20])}"
        notes.append(Problem("point sets", what))
    full = _counts(content)["hexahedron27"]
    if full:
        notes.append(Problem("cells", f"{full} hexahedra of 27 nodes are read as 20-node ones"))
    return notes
