"""The part of the reduction benchmark: a thick steel ring, both faces rigid interfaces, 20 inner modes.

    u = Psi q + Phi eta,   K_ii Phi = M_ii Phi Lambda,   Khat = T' K T,   Mhat = T' M T,   T = [Psi Phi]  (1)

Radii 0.1 and 0.2 m, height 0.1 m, 8-node hexahedra of nearly equal edges. flexarm assembles K and M; the
other codes read the same numbers from a file.
"""

from pathlib import Path

import numpy as np
from scipy import sparse

INNER, OUTER, HEIGHT = 0.1, 0.2, 0.1  # m
STEEL = {"youngs_modulus": 2.1e11, "poisson_ratio": 0.3, "density": 7850.0}
MODES = 20
FACES = {"bottom": (0.0, 0.0, 0.0), "top": (0.0, 0.0, HEIGHT)}
"""Interfaces: set of points, position of the frame."""

CELLS = {"3k": (4, 40), "10k": (6, 68), "35k": (10, 96), "98k": (14, 145), "300k": (21, 207)}
"""Size -> cells across height and width, and around."""


def mesh(size):
    """The ring in flexarm."""
    from flexarm.solids import Material, ring

    across, around = CELLS[size]
    steel = Material(**STEEL)
    return ring(INNER, OUTER, HEIGHT, size=HEIGHT / across, around=around, order=1, material=steel)


def write(size, file):
    """K, M (lower triangles), points and interfaces as the other codes read them."""
    from flexarm import _core

    part = mesh(size)
    K, M = _core.assemble_solids(part.core())
    arrays = {f"set_{name}": part.point_set(name) for name in FACES} | {"points": part.points}
    for name, matrix in (("K", K), ("M", M)):
        arrays |= {f"{name}_{key}": getattr(matrix, key) for key in ("data", "indices", "indptr")}
    np.savez(file, **arrays)


class Part:
    """The free part from its file, matrices in full."""

    def __init__(self, file):
        with np.load(Path(file)) as arrays:
            self.points = arrays["points"]
            self.faces = [arrays[f"set_{name}"] for name in FACES]
            self.K, self.M = (_full(arrays, name) for name in "KM")
        self.positions = [np.array(position) for position in FACES.values()]

    def face_motions(self):
        """Displacement of the faces' points by the six freedoms of each face, (freedoms of the part, 12)."""
        motions = np.zeros((self.points.size, 6 * len(self.faces)))
        for k, (points, origin) in enumerate(zip(self.faces, self.positions, strict=True)):
            for axis in range(3):
                motions[3 * points + axis, 6 * k + axis] = 1.0
                turn = np.cross(np.eye(3)[axis], self.points[points] - origin)
                for direction in range(3):
                    motions[3 * points + direction, 6 * k + 3 + axis] = turn[:, direction]
        return motions

    def inner(self):
        """Freedoms that follow no face."""
        free = np.ones(self.points.size, bool)
        for points in self.faces:
            free[(3 * points[:, None] + np.arange(3)).ravel()] = False
        return np.flatnonzero(free)


def _full(arrays, name):
    n = len(arrays[f"{name}_indptr"]) - 1
    parts = tuple(arrays[f"{name}_{key}"] for key in ("data", "indices", "indptr"))
    lower = sparse.csc_matrix(parts, shape=(n, n))
    return (lower + sparse.tril(lower, -1).T).tocsc()
