"""Readings that are counts: they lie on a lattice,

y_i = y_0 + k_i step,    k_i whole numbers.                                                       (1)
"""

from __future__ import annotations

import numpy as np

from flexarm.arrays import Floats

ON_LATTICE = 0.02
"""Greatest distance of a reading from (1), in steps."""
FEW = 8
"""Different readings that show no lattice."""


def quantisation_step(values: Floats) -> float:
    """Step of (1), 0 if readings are on no lattice or too few to tell."""
    found = np.unique(np.round(values[np.isfinite(values)], 14))
    if len(found) < FEW:
        return 0.0
    step = float(np.diff(found).min())
    for _ in range(2):  # the first guess drifts over many steps
        count = np.round((found - found[0]) / step)
        step = float(count @ (found - found[0]) / (count @ count))
    away = np.abs((found - found[0]) / step - np.round((found - found[0]) / step))
    return step if away.max() < ON_LATTICE else 0.0
