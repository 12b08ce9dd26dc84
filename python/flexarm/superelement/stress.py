"""Stress in the full part, from the coordinates of its super-element."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from flexarm import _core as _typed_core
from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter

if TYPE_CHECKING:
    from flexarm.solids import SolidMesh
    from flexarm.superelement import SuperElement

_core: Any = _typed_core


def von_mises(element: SuperElement, mesh: SolidMesh, coordinates: ArrayLike) -> Floats:
    """Return the von Mises stress at all points [Pa], averaged over the cells that meet there.

    Raise InvalidParameter if the super-element holds no recovery matrix, or not one of this mesh.
    """
    displacements = element.recover(coordinates)
    if len(displacements) != mesh.n_points:
        what = f"was reduced from {len(displacements)} points, the mesh has {mesh.n_points}"
        raise InvalidParameter(what, where=f"super-element {element.name!r}")
    return np.asarray(_core.von_mises(mesh.core(), displacements))
