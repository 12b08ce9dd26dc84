"""Connected points, coincident points and the surface of a mesh."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats, Ints
from flexarm.solids.cell_types import CELL_TYPES

if TYPE_CHECKING:
    from flexarm.solids.mesh import SolidMesh


def used_points(cells: Iterable[Ints], n_points: int) -> NDArray[np.bool_]:
    """Return True for every point that a cell uses."""
    used = np.zeros(n_points, dtype=bool)
    for nodes in cells:
        used[nodes.ravel()] = True
    return used


def connected(first: Ints, other: Ints, n_points: int) -> tuple[int, Ints]:
    """Return the number of sets of points that pairs connect, and the set of each point."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    links = coo_matrix((np.ones(len(first), np.int8), (first, other)), shape=(n_points, n_points))
    count, labels = connected_components(links, directed=False)
    return int(count), labels


def components(mesh: SolidMesh) -> tuple[int, Ints]:
    """Return the number of pieces that share no point, and the piece of each point."""
    first = np.concatenate([np.repeat(nodes[:, 0], nodes.shape[1]) for nodes in mesh.cells.values()])
    other = np.concatenate([nodes.ravel() for nodes in mesh.cells.values()])
    return connected(first, other, mesh.n_points)


def shortest_edge(mesh: SolidMesh) -> float:
    """Return the length of the shortest edge that has one [m]."""
    shortest = np.inf
    for kind, nodes in mesh.cells.items():
        edges = nodes[:, np.array(CELL_TYPES[kind].edges)]
        lengths = np.linalg.norm(mesh.points[edges[..., 0]] - mesh.points[edges[..., 1]], axis=-1)
        shortest = min(shortest, lengths[lengths > 0].min(initial=np.inf))
    return float(shortest)


def coincident(points: Floats, tolerance: float) -> Ints:
    """Return the pairs of points at most `tolerance` apart, shape (n, 2), each pair once."""
    from scipy.spatial import cKDTree

    pairs = cKDTree(points).query_pairs(tolerance, output_type="ndarray")
    return pairs[np.lexsort(pairs.T[::-1])]  # type: ignore[no-any-return]


def surface(mesh: SolidMesh) -> list[tuple[int, ...]]:
    """Return the faces that belong to one cell only: corner points, seen from outside anticlockwise."""
    faces: dict[int, list[Ints]] = {3: [], 4: []}
    for kind, nodes in mesh.cells.items():
        for corners in CELL_TYPES[kind].faces:
            faces[len(corners)].append(nodes[:, corners])
    found: list[tuple[int, ...]] = []
    for parts in faces.values():
        if parts:
            found += map(tuple, outer_faces(np.concatenate(parts)).tolist())
    return found


def outer_faces(faces: Ints) -> Ints:
    """Return the faces (n, nodes) that occur once, whatever the order of their nodes."""
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    kept: Ints = faces[np.sort(first[count == 1])]
    return kept
