"""A mesh as a VTU file: points, cells, a mask on points for each set, a mask on cells for each group."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Ints
from flexarm.errors import InvalidParameter
from flexarm.output import output_file
from flexarm.solids.cell_types import CELL_TYPES

if TYPE_CHECKING:
    from flexarm.solids.mesh import SolidMesh


def save(mesh: SolidMesh, path: Path, *, force: bool) -> Path:
    """Write `path`; an existing file is replaced only by `force`. Materials are not written: VTU has none."""
    import meshlane

    if path.suffix.lower() != ".vtu":
        raise InvalidParameter(f"must end in .vtu, got {path.name!r}", where="path")
    if path.exists() and not force:
        raise InvalidParameter(f"{path} exists; force = True replaces it", where="path")
    kinds = list(mesh.cells)
    written = meshlane.Mesh(
        mesh.points,
        [(CELL_TYPES[kind].meshio, mesh.cells[kind]) for kind in kinds],
        point_data={name: _mask(mesh.n_points, points) for name, points in mesh.point_sets.items()},
        cell_data={
            name: [_mask(len(mesh.cells[kind]), group.get(kind, np.empty(0, int))) for kind in kinds]
            for name, group in mesh.cell_groups.items()
        },
    )
    with output_file(path) as partial:
        meshlane.vtu.write(str(partial), written)
    return path


def _mask(n: int, indices: Ints) -> np.typing.NDArray[np.int8]:
    mask = np.zeros(n, dtype=np.int8)
    mask[indices] = 1
    return mask
