r"""Matrices in millimetres, tonnes and seconds as matrices in SI.

A matrix is a quadratic form that gives an energy. With l the unit of length and e = that of energy, and
coordinates u = S u_SI, S being 1/l for translations and 1 for rotations,

.. math:: K_{SI} = e \, S K S, \qquad M_{SI} = e \, S M S, \qquad C_{SI} = e \, S C S                  (1)

In mm, t, s the force is N, the stress MPa and the energy N mm: l = e = 10^-3 in m and J. A modal coordinate
takes S = e^-1/2, which leaves its unit mass and its squared frequency as they are.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter
from flexarm.superelement.foreign.labelled import SCALAR, Freedom

SYSTEMS = {"m": (1.0, 1.0), "mm": (1e-3, 1e-3)}
"""Unit of length [m] and of energy [J] of a consistent system, by its length; s is the time of both."""


def system(unit: str) -> tuple[float, float]:
    """Return the length and energy of a unit system.

    Raise InvalidParameter if it is not known.
    """
    if unit not in SYSTEMS:
        allowed = "m (m, kg, s, N) and mm (mm, t, s, N)"
        raise InvalidParameter(f"{unit!r} is not known for matrices; allowed are {allowed}", where="unit")
    return SYSTEMS[unit]


def in_si(matrix: Floats, freedoms: Sequence[Freedom], unit: str) -> Floats:
    """Return a matrix in SI units, eq. (1)."""
    length, energy = system(unit)
    scale = (
        {kind: 1.0 for kind in (4, 5, 6)} | {kind: 1 / length for kind in (1, 2, 3)} | {SCALAR: energy**-0.5}
    )
    S = np.array([scale[freedom.component] for freedom in freedoms])
    return np.asarray(energy * matrix * np.outer(S, S))
