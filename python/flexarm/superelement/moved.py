r"""A super-element in another frame.

With the part's own frame at (R, p) in the new one, an interface at x stands at R x + p, and T = diag(R, ..,
R, 1) turns the freedoms of all interfaces and leaves the modes:

.. math:: K' = T K T^T, \quad M' = T M T^T, \quad C' = T C T^T, \quad L' = T L R^T                   (1)

with L the load of unit accelerations of the frame, M R_t; displacements that are recovered turn with R.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from flexarm.superelement.rigid_motion import PER_INTERFACE

if TYPE_CHECKING:
    from flexarm.superelement.element import SuperElement


def moved(element: SuperElement, rotation: ArrayLike, translation: ArrayLike) -> SuperElement:
    """Return the part seen from a frame in which its own stands at (rotation, translation)."""
    R, p = np.asarray(rotation, dtype=float), np.asarray(translation, dtype=float)
    T = np.eye(element.n_dof)
    for at in range(0, PER_INTERFACE * element.n_interfaces, 3):
        T[at : at + 3, at : at + 3] = R
    recovery = None
    if element.recovery is not None:
        shapes = element.recovery.reshape(-1, 3, element.n_dof)
        recovery = (R @ shapes @ T.T).reshape(-1, element.n_dof)
    return element.replace(
        positions=element.positions @ R.T + p,
        rotations=R @ element.rotations,
        stiffness=T @ element.stiffness @ T.T,  # eq. (1)
        mass=T @ element.mass @ T.T,
        damping=T @ element.damping @ T.T,
        inertia_load=T @ element.inertia_load @ R.T,
        recovery=recovery,
    )
