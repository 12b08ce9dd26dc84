"""Types of cells in Abaqus and CalculiX, and their nodes.

Solids are named after their number of nodes: C3D4, C3D10, C3D8, C3D20, with letters for the formulation
behind (C3D8R, C3D8I, C3D10M, ..), which flexarm replaces by its own. Their nodes are in the order of VTK.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from flexarm.decks.keywords import Keyword

_SOLID = re.compile(r"D?C3D(\d+)")
_KINDS = {
    4: "tetra",
    5: "pyramid",
    6: "wedge",
    8: "hexahedron",
    10: "tetra10",
    13: "pyramid13",
    15: "wedge15",
    20: "hexahedron20",
}
#: Beginnings of the names of shells, membranes, surfaces and plane cells, and of trusses and beams.
_FACES = re.compile(r"D?(S|STRI|M3D|CPS|CPE|CAX|SFM3D|R3D|F3D)\d")
_LINES = re.compile(r"(T[23]D|B[23]|D1D|R2D2|PIPE)\d?")


def kind_of(name: str) -> str:
    """Return meshio's name of a type; empty for springs, masses, connectors and the like."""
    solid = _SOLID.match(name)
    if solid:
        return _KINDS.get(int(solid.group(1)), name)
    if _FACES.match(name):
        return "polygon"
    if _LINES.match(name):
        return "line"
    return "" if not name.startswith(("SC", "CSS", "AC3D", "COH3D", "GK3D", "EC3D")) else name


def rows_of(keyword: Keyword, name: str) -> Iterator[list[int]]:
    """Yield number and nodes of each cell.

    A solid has as many nodes as its name says, on as many lines as it takes; what else stands in the last of
    them is left out, as both programs do. Other cells go on in the next line where one ends in a comma.
    """
    solid = _SOLID.match(name)
    length = int(solid.group(1)) + 1 if solid else 0
    row: list[int] = []
    for line, values in keyword.rows:
        row += keyword.numbers(line, values)
        if solid and len(row) >= length:
            yield row[:length]
            row = []
        elif not solid and values[-1]:
            yield row
            row = []
    if row and solid:
        raise keyword.error(
            f"cell {row[0]} has {len(row) - 1} nodes, {name} has {length - 1}", keyword.rows[-1][0]
        )
    if row:
        yield row
