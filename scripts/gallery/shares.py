r"""How much of one gap another effect could explain, once clocks and frames are aligned.

With the gap g and the signatures S of a rival (one column a parameter), both over the noise, and Q an
orthonormal basis of the nuisances N,

    P = 1 - Q Q^T,      R^2 = max_c 1 - |P g - P S c|^2 / |P g|^2 = |U^T P g|^2 / |P g|^2            (1)

where U is an orthonormal basis of P S. R^2 = 1: the rival explains the gap as well as the effect itself does.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

LEFT = 0.03
"""Share of its length below which what is left of a gap counts as aligned away."""
WEAK = 1e-3
"""Singular value, over the greatest one, below which a direction says nothing about the size of a rival."""
RANK = 1e-6
"""Singular value, over the greatest one, below which columns count as dependent."""


def orthonormal(columns: Floats) -> Floats:
    """Basis of the space of columns, shape (n, rank), each column counting alike whatever its length."""
    length = np.linalg.norm(columns, axis=0)
    columns = columns[:, length > 0] / length[length > 0]
    if not columns.size:
        return columns[:, :0]
    left, values, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(left[:, values > RANK * values[0]])


def without(columns: Floats, nuisances: Floats) -> Floats:
    """P of (1) times each column; `nuisances` is an orthonormal basis."""
    return np.asarray(columns - nuisances @ (nuisances.T @ columns))


def lasting(columns: Floats, nuisances: Floats) -> Floats:
    """P of (1) times those columns that are not themselves nuisances: more than `LEFT` of them remains."""
    rest = without(columns, nuisances)
    return rest[:, np.linalg.norm(rest, axis=0) > LEFT * np.linalg.norm(columns, axis=0)]


def multiples(gap: Floats, columns: Floats) -> Floats:
    """c of (1), multiples of the columns of P S; directions that hardly count are left out."""
    found: Floats = np.linalg.lstsq(columns, gap, rcond=WEAK)[0]
    return found


def share_explained(gap: Floats, rival: Floats) -> float:
    """R^2 of (1) for P g, shape (n,), and an orthonormal basis U of the rival's P S, shape (n, rank)."""
    return float(np.sum((rival.T @ gap) ** 2) / np.sum(gap**2))  # eq. (1)
