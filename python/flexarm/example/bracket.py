"""A solid mesh as a CAD program exports it: a collar with a bore and a flange, Abaqus format, millimetres."""

from __future__ import annotations

import numpy as np

from flexarm.arrays import Ints
from flexarm.solids import Block, Patch, SolidMesh, revolved

MILLIMETRE = 1e-3
MATERIAL = """*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*DENSITY
7.85E-9
*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL"""


def bracket() -> str:
    """Return the file's text: sets BORE (bearing seat) and FLANGE (face that carries), steel, N mm s t."""
    size = MILLIMETRE
    mesh = revolved(
        [
            Block("sleeve", 30 * size, 45 * size, 0.0, 60 * size),
            Block("plate", 30 * size, 80 * size, 60 * size, 72 * size),
        ],
        patches=[
            Patch("BORE", 30 * size, 30 * size, 0.0, 40 * size),
            Patch("FLANGE", 60 * size, 80 * size, 72 * size, 72 * size),
        ],
        size=15 * size,
    )
    return "\n".join(["*HEADING", "collar, mm", *_nodes(mesh), *_cells(mesh), *_sets(mesh), MATERIAL, ""])


def _nodes(mesh: SolidMesh) -> list[str]:
    rows = [f"{i}, {x:.6g}, {y:.6g}, {z:.6g}" for i, (x, y, z) in enumerate(mesh.points / MILLIMETRE, 1)]
    return ["*NODE", *rows]


def _cells(mesh: SolidMesh) -> list[str]:
    """Return hexahedra of 20 nodes, whose order in Abaqus is that of VTK."""
    rows = []
    for i, nodes in enumerate(mesh.cells["hex20"], 1):
        rows.append(_listed(np.array([i, *(nodes[:15] + 1)], dtype=np.int32)) + ",")
        rows.append(_listed(nodes[15:] + 1))
    return ["*ELEMENT, TYPE=C3D20, ELSET=BODY", *rows]


def _sets(mesh: SolidMesh) -> list[str]:
    a_line = 16  # numbers a line of the file
    rows = []
    for name in ("BORE", "FLANGE"):
        nodes = mesh.point_sets[name] + 1
        rows.append(f"*NSET, NSET={name}")
        rows += [_listed(nodes[k : k + a_line]) for k in range(0, len(nodes), a_line)]
    return rows


def _listed(numbers: Ints) -> str:
    return ", ".join(str(number) for number in numbers)
