"""Volume and Jacobians of hexahedra from the monomials they span: nothing of flexarm's own elements."""

from itertools import product

import numpy as np

from flexarm.solids import CELL_TYPES, SolidMesh

_CORNERS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]]
)
_POWERS = {
    "hex8": [p for p in product(range(2), repeat=3)],
    "hex20": [p for p in product(range(3), repeat=3) if sum(i for i in p if i == 2) <= 2 and p.count(2) < 2],
}


def _nodes(kind: str) -> np.ndarray:
    middles = [_CORNERS[list(edge)].mean(axis=0) for edge in CELL_TYPES[kind].edges]
    return np.vstack([_CORNERS, middles]) if kind == "hex20" else _CORNERS


def _gradients(kind: str, at: np.ndarray) -> np.ndarray:
    """dN/dxi at one place, shape (3, n_nodes)."""
    powers = np.array(_POWERS[kind])
    values = np.prod(_nodes(kind)[:, None, :] ** powers, axis=2)
    slopes = []
    for axis in range(3):
        lower = powers.copy()
        lower[:, axis] = np.maximum(powers[:, axis] - 1, 0)
        slopes.append(powers[:, axis] * np.prod(at**lower, axis=1))
    return np.array(slopes) @ np.linalg.inv(values)


def jacobians(mesh: SolidMesh, kind: str) -> tuple[np.ndarray, np.ndarray]:
    """det J at 4 x 4 x 4 Gauss points of every cell, and the weights."""
    x, w = np.polynomial.legendre.leggauss(4)
    places = np.array(list(product(x, repeat=3)))
    weights = np.prod(np.array(list(product(w, repeat=3))), axis=1)
    nodes = mesh.points[mesh.cells[kind]]
    found = [np.linalg.det(np.einsum("an,cnb->cab", _gradients(kind, at), nodes)) for at in places]
    return np.array(found), weights


def volume(mesh: SolidMesh) -> float:
    """Volume of the part [m3]."""
    total = 0.0
    for kind in mesh.cells:
        found, weights = jacobians(mesh, kind)
        total += float(weights @ found.sum(axis=1))
    return total
