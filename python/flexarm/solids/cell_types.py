"""The solid cells that flexarm computes with: their nodes, edges and faces.

Node order is that of VTK (vtkTetra, vtkQuadraticTetra, vtkHexahedron, vtkQuadraticHexahedron): corners
first, then one node in the middle of each edge in the order of `edges`. Faces are in the order of Abaqus and
CalculiX, whose labels S1 to S6 name them, with corner nodes only; `face_nodes` adds the middle nodes.
"""

from __future__ import annotations

from dataclasses import dataclass

_TET_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
_TET_FACES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))
_HEX_EDGES = (
    *((0, 1), (1, 2), (2, 3), (3, 0)),
    *((4, 5), (5, 6), (6, 7), (7, 4)),
    *((0, 4), (1, 5), (2, 6), (3, 7)),
)
_HEX_FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


@dataclass(frozen=True)
class CellType:
    """One kind of cell."""

    name: str
    """`tet4`, `tet10`, `hex8` or `hex20`."""
    meshio: str
    """Its name in meshio and meshlane."""
    n_corners: int
    n_nodes: int
    """Number of corner nodes and of all nodes."""
    edges: tuple[tuple[int, int], ...]
    faces: tuple[tuple[int, ...], ...]
    """Corner nodes of each edge, and of each face anticlockwise as seen from outside."""

    def face_nodes(self, face: int) -> tuple[int, ...]:
        """Return all nodes of a face: its corners, then the middle nodes of its edges."""
        corners = self.faces[face]
        if self.n_nodes == self.n_corners:
            return corners
        middles = (self.n_corners + i for i, edge in enumerate(self.edges) if set(edge) <= set(corners))
        return (*corners, *middles)


CELL_TYPES: dict[str, CellType] = {
    kind.name: kind
    for kind in (
        CellType("tet4", "tetra", 4, 4, _TET_EDGES, _TET_FACES),
        CellType("tet10", "tetra10", 4, 10, _TET_EDGES, _TET_FACES),
        CellType("hex8", "hexahedron", 8, 8, _HEX_EDGES, _HEX_FACES),
        CellType("hex20", "hexahedron20", 8, 20, _HEX_EDGES, _HEX_FACES),
    )
}
BY_MESHIO_NAME: dict[str, CellType] = {kind.meshio: kind for kind in CELL_TYPES.values()}
ALLOWED = "4- and 10-node tetrahedra, 8- and 20-node hexahedra"
