"""Boxes of hexahedra, made with NumPy alone."""

import numpy as np
from numpy.typing import ArrayLike

from flexarm.material import Material
from flexarm.solids import SolidMesh

STEEL = Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)

# Where the nodes of a 20-node hexahedron stand, in halves of its edges, in the order of VTK.
_CORNERS = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
_PLACES = np.array(
    _CORNERS + [tuple((np.array(_CORNERS[a]) + _CORNERS[b]) // 2) for a, b in _EDGES], dtype=int
)


def box(size: ArrayLike, counts: tuple[int, int, int], kind: str = "hex20") -> SolidMesh:
    """A box from the origin, centred on the z axis, of counts cells; point sets "bottom" and "top"."""
    places = _PLACES if kind == "hex20" else _PLACES[:8]
    first = 2 * np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 1, 3)
    lattice, cells = np.unique((first + places).reshape(-1, 3), axis=0, return_inverse=True)
    lengths = np.asarray(size, float)
    points = lattice * lengths / (2 * np.array(counts)) - [lengths[0] / 2, lengths[1] / 2, 0]
    return SolidMesh(
        points=points,
        cells={kind: cells.reshape(-1, len(places))},
        cell_groups={"box": {kind: np.arange(len(first))}},
        point_sets={
            "bottom": np.flatnonzero(lattice[:, 2] == 0),
            "top": np.flatnonzero(lattice[:, 2] == 2 * counts[2]),
        },
        materials={"box": STEEL},
    )
