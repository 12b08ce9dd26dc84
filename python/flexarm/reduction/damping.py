r"""Damping of a reduced part: stiffness-proportional, so that rigid motion is never damped.

.. math:: C = \beta K, \qquad \beta = 2 \zeta / \omega_1                                             (1)

gives the first elastic mode of the free part, of frequency omega_1, the damping ratio zeta, and a mode of
frequency omega the ratio zeta omega/omega_1.
"""

from __future__ import annotations

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter


def stiffness_proportional(stiffness: Floats, mass: Floats, damping_ratio: float) -> Floats:
    """Return C of (1).

    Raises
    ------
    InvalidParameter
        If the ratio is not in [0, 1), or the part is rigid.
    """
    if not 0 <= damping_ratio < 1:
        raise InvalidParameter(f"must be in [0, 1), got {damping_ratio:g}", where="damping_ratio")
    if damping_ratio == 0:
        return np.zeros_like(stiffness)
    elastic = free_frequencies(stiffness, mass)
    if not len(elastic):
        what = "needs an elastic mode: the part has one interface and no internal modes, so it is rigid"
        raise InvalidParameter(what, where="damping_ratio")
    return np.asarray(2 * damping_ratio / (2 * np.pi * elastic[0]) * stiffness)  # eq. (1)


def free_frequencies(stiffness: Floats, mass: Floats) -> Floats:
    """Return the frequencies of the free part [Hz] without its six rigid motions."""
    from scipy.linalg import eigh

    squares = eigh(stiffness, mass, eigvals_only=True)[6:]
    return np.asarray(np.sqrt(np.maximum(squares, 0)) / (2 * np.pi))
