"""VTK unstructured grids (.vtu), as ParaView, pyvista and many solvers write them.

VTU has no sets. By convention here, an array of zeros and ones on points is the set of the points where it is
one; an array of zeros and ones on cells is the group, or for surface cells the set, of those where it is one;
any other array of whole numbers on cells is a group `ARRAY-NUMBER` for each number in it.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from flexarm.arrays import Ints
from flexarm.errors import InvalidFile
from flexarm.solids.reading.content import Content
from flexarm.solids.reading.through_meshlane import blocks_of, read_by

_NOT_GROUPS = re.compile(r"vtkOriginal|GlobalNodeId|GlobalElementId|GlobalCellId|vtkGhost", re.IGNORECASE)


def content(path: Path) -> Content:
    """Read the content of a VTU file."""
    return read_by(_content, path, "VTK unstructured grid")


def _content(path: Path) -> Content:
    import meshlane

    mesh = meshlane.vtu.read(str(path))
    blocks = blocks_of(mesh)
    _refuse_losses(path, sum(len(block.data) for block in mesh.cells))
    found = Content(np.asarray(mesh.points, float), np.arange(1, len(mesh.points) + 1), blocks)
    for name, values in mesh.point_data.items():
        array = np.asarray(values)
        if array.ndim == 1 and _is_mask(array) and not _NOT_GROUPS.match(name):
            found.point_sets[name] = np.flatnonzero(array)
    for name, parts in mesh.cell_data.items():
        if not _NOT_GROUPS.match(name):
            found.groups |= _groups(name, [np.asarray(part) for part in parts])
    return found


def _groups(name: str, parts: list[Any]) -> dict[str, dict[int, Ints]]:
    most_numbers = 1000
    whole: Any = np.concatenate(parts) if parts else np.empty(0)
    if whole.ndim != 1 or whole.dtype.kind not in "iub" or not whole.size:
        return {}
    if _is_mask(whole):
        return {name: {i: np.flatnonzero(part) for i, part in enumerate(parts)}}
    numbers = np.unique(whole)
    if len(numbers) > min(most_numbers, max(1, len(whole) // 2)):  # numbers of cells, not of groups
        return {}
    return {
        f"{name}-{number}": {i: np.flatnonzero(part == number) for i, part in enumerate(parts)}
        for number in numbers
    }


def _is_mask(values: Ints) -> bool:
    return values.dtype.kind in "iub" and bool(np.isin(values, (0, 1)).all()) and bool(values.any())


def _refuse_losses(path: Path, n_read: int) -> None:
    """Refuse several pieces, of which meshlane keeps the last, and types of cells that it skips."""
    pieces = re.findall(rb"<Piece[^>]*NumberOfCells\s*=\s*[\"']\s*(\d+)", path.read_bytes())
    if len(pieces) > 1:
        raise InvalidFile(path, "UnstructuredGrid", f"holds {len(pieces)} pieces; save it as one")
    if pieces and int(pieces[0]) != n_read:
        what = f"{int(pieces[0]) - n_read} of {int(pieces[0])} cells are of types that cannot be read"
        raise InvalidFile(path, "Cells", what)
