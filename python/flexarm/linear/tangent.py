r"""The motion of an arm near its loaded equilibrium.

Coordinates x of all nodes and joints, motors' angles included, move as

.. math:: M x'' + C x' + K x + J^T \lambda = F u,   J x = 0                                          (1)

with the true tangent K (geometric stiffness and gravity in it). Motions that joints, gears and closures
allow, in which the angles w of driven motors are coordinates of their own, are

.. math:: x = N z + G w,   J N = 0,   J G = 0,   N_{driven} = 0,   (G w)_{driven} = w                (2)

A motor behind a spring turns alone: its column of G has no other entry. If a motor holds its link, G is the
arm's quasi-static motion with it, N^T K G = 0, which needs stiffness in all other motions. z is what the arm
does beyond. The projection of (1) on N and G,

.. math:: M_z z'' + C_z z' + K_z z = N^T F u - N^T (M G w'' + C G w' + K G w)                         (3)
.. math:: T = G^T (M x'' + C x' + K x - F u)                                                          (4)

moves the arm and gives the torques T of the motors that hold w.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexarm import _core
from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter

_RANK = 1e-10
"""Relative size below which a pivot of the constraints is zero."""


@dataclass(frozen=True, eq=False)
class Tangent:
    """Matrices of (1) and bases of (2)."""

    M: Floats
    C: Floats
    K: Floats
    """Of the coordinates x, shape (n, n)."""
    N: Floats
    G: Floats
    """Motions that the joints allow, (2), shapes (n, free) and (n, driven)."""

    @property
    def motions(self) -> Floats:
        """Columns of N, then of G."""
        return np.hstack([self.N, self.G])


def tangent(system: _core.System, equilibrium: _core.Equilibrium, driven: Sequence[int]) -> Tangent:
    """Linearise the torque-driven system about its equilibrium.

    `driven` are rows of the coordinates that are prescribed.

    Raise InvalidParameter if driven joints are not independent, or the arm is too large.
    """
    max_coordinates = 3000  # beyond, dense matrices take minutes
    if system.n_unknowns > max_coordinates:
        raise InvalidParameter(
            f"the arm has {system.n_unknowns} unknowns; a linear model is made of up to {max_coordinates}; "
            "take fewer elements",
            where="links",
        )
    M, C, K, J = _core.tangents(system, equilibrium)
    allowed = _null_space(J)
    selected = allowed[list(driven)]
    if np.linalg.matrix_rank(selected, tol=_RANK) < len(driven):
        raise InvalidParameter(
            "driven joints depend on one another through gears or closures; drive fewer of them"
        )
    N = allowed @ _null_space(selected)
    N[list(driven)] = 0
    G = _quasi_static(N, allowed @ np.linalg.pinv(selected), K)
    for k, row in enumerate(driven):
        if not J[:, row].any():  # a motor behind a spring turns alone
            G[:, k] = 0
            G[row, k] = 1
    return Tangent(M, C, K, N, G)


def _quasi_static(N: Floats, G: Floats, K: Floats) -> Floats:
    """Return G with N^T K G = 0, or as it is where the arm has a motion without stiffness."""
    stiffness = N.T @ K @ N
    if not len(stiffness):
        return G
    if is_singular(stiffness):
        return G
    return G - N @ np.linalg.solve(stiffness, N.T @ K @ G)


def is_singular(K: Floats, rounding: float = 1e-13) -> bool:
    """Return True if a symmetric matrix has an eigenvalue that is zero but for rounding."""
    values = np.abs(np.linalg.eigvalsh(0.5 * (K + K.T)))
    return bool(values.min() <= rounding * values.max())


def _null_space(J: Floats) -> Floats:
    """Return orthonormal columns that span the null space."""
    from scipy.linalg import qr

    if not len(J):
        return np.eye(J.shape[1])
    Q, R, _ = qr(J.T, pivoting=True)
    pivots = np.abs(np.diag(R))
    rank = int(np.sum(pivots > _RANK * pivots[0]))
    return np.asarray(Q[:, rank:])
