"""The material of each cell."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from difflib import get_close_matches
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Ints
from flexarm.errors import InvalidParameter, Problem
from flexarm.material import Material

if TYPE_CHECKING:
    from flexarm.solids.mesh import SolidMesh

_NONE = -1


def material_indices(mesh: SolidMesh) -> tuple[list[Material], dict[str, Ints]]:
    """Return the materials in use and, for each type of cell, the index of each cell's material.

    Raise InvalidParameter if a cell has no material, or two that differ.
    """
    names, indices = _by_group(mesh)
    bare = _without(mesh, indices)
    if bare:
        raise mesh.error(bare.where, bare.what)
    return [mesh.materials[name] for name in names], indices


def material_problems(mesh: SolidMesh) -> list[Problem]:
    """Return the problems for which `material_indices` would fail; empty if there are none."""
    try:
        _, indices = _by_group(mesh)
    except InvalidParameter as error:
        return list(error.problems)
    bare = _without(mesh, indices)
    return [bare] if bare else []


def with_materials(mesh: SolidMesh, materials: Mapping[str, Material] | Material) -> SolidMesh:
    """Return the mesh with materials by group, or with one for all cells that have none."""
    if not isinstance(materials, Material):
        return replace(mesh, materials={**mesh.materials, **materials})
    _, indices = _by_group(mesh)
    left = {kind: np.flatnonzero(index == _NONE) for kind, index in indices.items()}
    left = {kind: cells for kind, cells in left.items() if len(cells)}
    if not left:
        note = Problem("material", "every cell has one of its own; that for the rest is not used")
        return replace(mesh, notes=(*mesh.notes, note))
    name = "rest" if mesh.materials else "all"
    while name in mesh.cell_groups:
        name += "-"
    return replace(
        mesh, cell_groups={**mesh.cell_groups, name: left}, materials={**mesh.materials, name: materials}
    )


def _by_group(mesh: SolidMesh) -> tuple[list[str], dict[str, Ints]]:
    names = list(mesh.materials)
    indices: dict[str, Ints] = {
        kind: np.full(len(nodes), _NONE, dtype=np.int32) for kind, nodes in mesh.cells.items()
    }
    for i, name in enumerate(names):
        if name not in mesh.cell_groups:
            known = known_names(name, mesh.cell_groups, "the mesh has no groups; give one for all")
            raise mesh.error(f"material of {name!r}", f"there is no such group of cells; {known}")
        for kind, cells in mesh.cell_groups[name].items():
            for j in set(indices[kind][cells].tolist()) - {_NONE}:
                if mesh.materials[names[j]] != mesh.materials[name]:
                    raise mesh.error(
                        f"material of {name!r}",
                        f"some of its cells are also in {names[j]!r}, which has another material",
                    )
            indices[kind][cells] = i
    return names, indices


def _without(mesh: SolidMesh, indices: Mapping[str, Ints]) -> Problem | None:
    bare = {kind: np.flatnonzero(index == _NONE) for kind, index in indices.items()}
    count = sum(len(cells) for cells in bare.values())
    if not count:
        return None
    groups = [
        name
        for name, group in mesh.cell_groups.items()
        if any(np.isin(cells, bare[kind]).any() for kind, cells in group.items())
    ]
    kind, cells = next((kind, cells) for kind, cells in bare.items() if len(cells))
    first = mesh.cell_numbers[kind][cells[0]]
    which = f"in groups {', '.join(groups[:20])}" if groups else f"such as cell {first}, which is in no group"
    why = [f"{note.where}: {note.what}" for note in mesh.notes if note.where.startswith("materials.")]
    return Problem(
        "materials",
        f"{count} of {mesh.n_cells} cells have no material ({which}); give one by group or one for all: "
        "Young's modulus [Pa], Poisson's ratio, density [kg/m3]" + "".join(f"; {text}" for text in why),
    )


def known_names(name: str, known: Iterable[str], none: str) -> str:
    """List the names there are, close ones first."""
    names = list(known)
    if not names:
        return none
    folded = {other.casefold(): other for other in names}
    close = [folded[match] for match in get_close_matches(name.casefold(), folded, n=3, cutoff=0.6)]
    meant = f" (did you mean {' or '.join(map(repr, close))}?)" if close else ""
    shown = ", ".join(names[:40]) + (f" and {len(names) - 40} more" if len(names) > 40 else "")
    return f"there are {shown}{meant}"
