r"""Rigid motion of a reduced part: six columns that its stiffness annihilates and that carry its mass.

A part that translates by t and turns by the small angle w about the origin moves its interface at p by

.. math:: u = t + w \times p, \quad \theta = w                                                       (1)

and leaves its fixed-interface modes at rest, since they are measured from the static shape that the
interfaces impose. With R the columns (1), three of t and three of w,

.. math::
    R^T M R = \begin{pmatrix} m \, 1 & -m \tilde c \\ m \tilde c & J_0 \end{pmatrix}                 (2)

holds the part's mass m, its centre c and its inertia J_0 about the origin; ~c x = c x x. Source: R. R. Craig
and A. J. Kurdila, Fundamentals of Structural Dynamics, 2nd ed., 2006, chapter 17.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexarm.arrays import Floats

PER_INTERFACE = 6
"""Freedoms of an interface: three translations, then three rotations."""

COMPONENTS = ("translation x", "translation y", "translation z", "rotation x", "rotation y", "rotation z")


@dataclass(frozen=True)
class RigidInertia:
    """Mass [kg], centre [m] and inertia about the centre [kg m2] of a body, in the part's frame."""

    mass: float
    centre: Floats
    inertia: Floats


def cross_matrix(p: ArrayLike) -> Floats:
    """Return the matrix ~p with ~p x = p x x."""
    x, y, z = np.asarray(p, dtype=float)
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def rigid_motions(positions: ArrayLike, n_modes: int, about: ArrayLike = (0.0, 0.0, 0.0)) -> Floats:
    """Return the columns (1) for every freedom, shape (6 n_interfaces + n_modes, 6).

    They are translations along x, y, z [m] and rotations about them [rad], which leave the point `about` in
    place. Interfaces stand at `positions` [m], (n_interfaces, 3), and internal modes stay at rest.
    """
    arms = np.asarray(positions, dtype=float).reshape(-1, 3) - np.asarray(about, dtype=float)
    motions = np.zeros((PER_INTERFACE * len(arms) + n_modes, 6))
    for i, arm in enumerate(arms):
        rows = slice(PER_INTERFACE * i, PER_INTERFACE * (i + 1))
        motions[rows] = np.eye(6)
        motions[rows][:3, 3:] = -cross_matrix(arm)  # eq. (1): w x p = -p x w
    return motions


def rigid_inertia(mass_matrix: Floats, positions: Floats) -> RigidInertia:
    """Return the mass, centre and inertia of a reduced part, eq. (2)."""
    n_modes = len(mass_matrix) - PER_INTERFACE * len(positions)
    motions = rigid_motions(positions, n_modes)
    block = motions.T @ mass_matrix @ motions
    mass = float(np.trace(block[:3, :3])) / 3
    if mass == 0:
        return RigidInertia(0.0, np.zeros(3), block[3:, 3:])
    first = (block[3:, :3] - block[3:, :3].T) / 2  # m ~c, eq. (2)
    centre = np.array([first[2, 1], first[0, 2], first[1, 0]]) / mass
    arm = cross_matrix(centre)
    return RigidInertia(mass, centre, block[3:, 3:] + mass * arm @ arm)  # Steiner: J_0 = J + m ~c^T ~c


def inertia_load(mass: ArrayLike, n_interfaces: int) -> Floats:
    """Return the generalised force for unit acceleration of the frame, M R_t, which needs no positions."""
    M = np.asarray(mass, dtype=float)
    if M.ndim != 2 or len(M) < PER_INTERFACE * n_interfaces:
        return np.zeros((len(M), 3))  # the shape of M itself is what will be reported
    columns = [M[:, k : PER_INTERFACE * n_interfaces : PER_INTERFACE].sum(axis=1) for k in range(3)]
    return np.column_stack(columns)


def freedom(index: int, interfaces: tuple[str, ...]) -> str:
    """Name a freedom: its interface and direction, or its internal mode."""
    at, component = divmod(index, PER_INTERFACE)
    if at < len(interfaces):
        return f"interface {interfaces[at]!r}, {COMPONENTS[component]}"
    return f"internal mode {index - PER_INTERFACE * len(interfaces) + 1}"
