"""20-node hexahedra from 8-node ones: a point in the middle of every edge, on the circle where there is one.

    m = (a + b)/2 ,   and r(m) = r   where r(a) = r(b) = r                                          (1)

An edge between two points of one circle is a chord, whose middle is moved out to the arc; all other edges
(along r, along z, inside the core) are straight.
"""

from __future__ import annotations

import numpy as np

from flexarm.arrays import Floats, Ints
from flexarm.solids.cell_types import CELL_TYPES


def with_middle_points(points: Floats, circle: Floats, cells: Ints) -> tuple[Floats, Ints]:
    """Return points and 20-node cells; `circle` is the radius of the circle a point lies on, or nan."""
    edges = np.sort(cells[:, np.array(CELL_TYPES["hex20"].edges)].reshape(-1, 2), axis=1)
    unique, inverse = np.unique(edges, axis=0, return_inverse=True)
    middle = points[unique].mean(axis=1)
    radius = circle[unique]
    arcs = radius[:, 0] == radius[:, 1]  # nan equals nothing
    middle[arcs, :2] *= (radius[arcs, 0] / np.linalg.norm(middle[arcs, :2], axis=1))[:, None]  # eq. (1)
    numbers = len(points) + inverse.reshape(len(cells), -1)
    return np.concatenate([points, middle]), np.hstack([cells, numbers])
