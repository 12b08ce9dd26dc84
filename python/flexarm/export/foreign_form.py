r"""A super-element over numbered points, in the units of another program.

Points are numbered from 1 in the order of the interfaces, internal modes after them. Freedoms stand along
the axes A of each point; with S of `superelement.foreign.unit`, the inverse of its eq. (1),

.. math:: X = S^{-1} A^T X_{SI} A S^{-1} / e                                                          (1)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexarm.arrays import Floats
from flexarm.superelement import SuperElement
from flexarm.superelement.foreign.labelled import SCALAR, Freedom
from flexarm.superelement.foreign.unit import in_si, system
from flexarm.superelement.rigid_motion import PER_INTERFACE


@dataclass(frozen=True, eq=False)
class ForeignForm:
    """Points [unit], axes as columns, freedoms and matrices (1)."""

    positions: Floats
    axes: Floats
    freedoms: tuple[Freedom, ...]
    stiffness: Floats
    mass: Floats
    damping: Floats


def foreign_form(
    element: SuperElement, unit: str, axes: Sequence[Floats] | Floats | None = None
) -> ForeignForm:
    """Return a super-element for another program.

    Unit "m" is m, kg, s, N, and "mm" is mm, t, s, N, MPa. `axes`, shape (n, 3, 3), are those of the points'
    freedoms, as columns; the part's own by default.

    Raise InvalidParameter if the unit is not known.
    """
    length, _ = system(unit)
    n = element.n_interfaces
    turned = np.tile(np.eye(3), (n, 1, 1)) if axes is None else np.asarray(axes)
    freedoms = [Freedom(i + 1, c) for i in range(n) for c in range(1, PER_INTERFACE + 1)]
    freedoms += [Freedom(n + 1 + k, SCALAR) for k in range(element.n_modes)]
    A = np.eye(element.n_dof)
    for i in range(n):
        for start in (PER_INTERFACE * i, PER_INTERFACE * i + 3):
            A[start : start + 3, start : start + 3] = turned[i]
    scale = in_si(np.ones((element.n_dof,) * 2), freedoms, unit)
    K, M, C = (A.T @ X @ A / scale for X in (element.stiffness, element.mass, element.damping))  # eq. (1)
    return ForeignForm(element.positions / length, turned, tuple(freedoms), K, M, C)
