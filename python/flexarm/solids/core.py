"""A mesh as the solver in C++ takes it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from flexarm import _core
from flexarm.arrays import Floats, Ints
from flexarm.material import Material

if TYPE_CHECKING:
    from flexarm.solids.mesh import SolidMesh


def core_mesh(mesh: SolidMesh, materials: Sequence[Material], indices: Mapping[str, Ints]) -> _core.SolidMesh:
    """Return points, blocks of cells with the index of each cell's material, and materials."""
    blocks = [
        _core.CellBlock(getattr(_core.CellType, kind), nodes, indices[kind])
        for kind, nodes in mesh.cells.items()
    ]
    solids = [_core.SolidMaterial(m.youngs_modulus, m.poisson_ratio, m.density) for m in materials]
    return _core.SolidMesh(mesh.points, blocks, solids)


def smallest_jacobians(mesh: SolidMesh) -> dict[str, Floats]:
    """Return for each cell the smallest det J over its integration points, 1 for an ideal cell."""
    any_material = [Material(youngs_modulus=1.0, poisson_ratio=0.0, density=1.0)]
    zeros = {kind: np.zeros(len(nodes), np.int32) for kind, nodes in mesh.cells.items()}
    found = _core.smallest_jacobians(core_mesh(mesh, any_material, zeros))
    return dict(zip(mesh.cells, found, strict=True))
