r"""Area of each point of a set: the integral of its shape function over the set's outer faces.

.. math:: a_i = \int_A N_i \, dA, \qquad \sum_i a_i = A                                              (1)

These are the forces of a unit pressure. On faces of second order corners get nothing or pull back (0 on
six-node triangles, -A/12 on eight-node quadrilaterals) and middles get a third each: spread so, a force
strains the part as an even pressure would, while equal shares make every point a small load of its own.
Source: Zienkiewicz and Taylor, The Finite Element Method, vol. 1, nodal forces of boundary tractions.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexarm.arrays import Floats, Ints
from flexarm.solids.cell_types import CELL_TYPES, CellType
from flexarm.solids.mesh import SolidMesh
from flexarm.solids.shape import outer_faces


def point_areas(mesh: SolidMesh, points: ArrayLike) -> Floats:
    """Return the area (1) of every point of a set [m2], shape (n,).

    All are zero unless every point lies on an outer face of a cell whose points are all in the set: the
    points of an edge stand for no area, whatever face they happen to close.
    """
    chosen = np.asarray(points)
    inside = np.zeros(mesh.n_points, dtype=bool)
    inside[chosen] = True
    area, covered = np.zeros(mesh.n_points), np.zeros(mesh.n_points, dtype=bool)
    for nodes in _outer_faces(mesh, inside):
        np.add.at(area, nodes, _integrals(mesh.points[nodes]))
        covered[nodes] = True
    return area[chosen] if covered[chosen].all() else np.zeros(len(chosen))


def _outer_faces(mesh: SolidMesh, inside: NDArray[np.bool_]) -> Iterator[Ints]:
    """Yield outer faces with all points inside, by number of nodes: (n, nodes)."""
    faces: dict[int, list[Ints]] = {}
    for name, cells in mesh.cells.items():
        kind = CELL_TYPES[name]
        near = cells[inside[cells].any(axis=1)]
        for face in range(len(kind.faces)):
            nodes = near[:, _face_nodes(kind, face)]
            faces.setdefault(nodes.shape[1], []).append(nodes[inside[nodes].all(axis=1)])
    for parts in faces.values():
        yield outer_faces(np.concatenate(parts))


def _face_nodes(kind: CellType, face: int) -> list[int]:
    """Return the corners in order, then the middle of the edge after each corner."""
    corners = kind.faces[face]
    if kind.n_nodes == kind.n_corners:
        return list(corners)
    edges = [frozenset(edge) for edge in kind.edges]
    around = zip(corners, (*corners[1:], corners[0]), strict=True)
    return [*corners, *(kind.n_corners + edges.index(frozenset(edge)) for edge in around)]


def _integrals(corners: Floats) -> Floats:
    """Return (1) of faces given by their nodes (n, nodes, 3)."""
    triangle = (((1 / 6, 1 / 6), (2 / 3, 1 / 6), (1 / 6, 2 / 3)), (1 / 6, 1 / 6, 1 / 6))
    n_nodes = corners.shape[1]
    places, weights = triangle if n_nodes in (3, 6) else _SQUARE
    total = np.zeros(corners.shape[:2])
    for (r, s), weight in zip(places, weights, strict=True):
        shape, along_r, along_s = _SHAPES[n_nodes](r, s)
        normal = np.cross(np.einsum("i,nik->nk", along_r, corners), np.einsum("i,nik->nk", along_s, corners))
        total += weight * np.linalg.norm(normal, axis=1)[:, None] * shape
    return total


# Rules exact for the shape functions on flat faces: three points in a triangle, three by three in a square.
_GAUSS = ((-np.sqrt(0.6), 5 / 9), (0.0, 8 / 9), (np.sqrt(0.6), 5 / 9))
_SQUARE = (
    tuple((r, s) for r, _ in _GAUSS for s, _ in _GAUSS),
    tuple(a * b for _, a in _GAUSS for _, b in _GAUSS),
)

Shape = tuple[Floats, Floats, Floats]
"""Shape functions and their derivatives by r and s."""


def _triangle_3(r: float, s: float) -> Shape:
    return np.array([1 - r - s, r, s]), np.array([-1.0, 1.0, 0.0]), np.array([-1.0, 0.0, 1.0])


def _triangle_6(r: float, s: float) -> Shape:
    t = 1 - r - s
    return (
        np.array([t * (2 * t - 1), r * (2 * r - 1), s * (2 * s - 1), 4 * t * r, 4 * r * s, 4 * s * t]),
        np.array([1 - 4 * t, 4 * r - 1, 0, 4 * (t - r), 4 * s, -4 * s]),
        np.array([1 - 4 * t, 0, 4 * s - 1, -4 * r, 4 * r, 4 * (t - s)]),
    )


_R, _S = np.array([-1.0, 1, 1, -1]), np.array([-1.0, -1, 1, 1])  # corners of the square


def _square_4(r: float, s: float) -> Shape:
    return (1 + r * _R) * (1 + s * _S) / 4, _R * (1 + s * _S) / 4, _S * (1 + r * _R) / 4


def _square_8(r: float, s: float) -> Shape:
    corner = (1 + r * _R) * (1 + s * _S) * (r * _R + s * _S - 1) / 4
    corner_r = _R * (1 + s * _S) * (2 * r * _R + s * _S) / 4
    corner_s = _S * (1 + r * _R) * (2 * s * _S + r * _R) / 4
    middle = np.array(
        [(1 - r * r) * (1 - s), (1 + r) * (1 - s * s), (1 - r * r) * (1 + s), (1 - r) * (1 - s * s)]
    )
    middle_r = np.array([-2 * r * (1 - s), 1 - s * s, -2 * r * (1 + s), -(1 - s * s)])
    middle_s = np.array([-(1 - r * r), -2 * s * (1 + r), 1 - r * r, -2 * s * (1 - r)])
    return (
        np.concatenate([corner, middle / 2]),
        np.concatenate([corner_r, middle_r / 2]),
        np.concatenate([corner_s, middle_s / 2]),
    )


_SHAPES = {3: _triangle_3, 6: _triangle_6, 4: _square_4, 8: _square_8}
