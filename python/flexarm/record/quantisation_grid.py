"""Quantisation grid of readings that are counts: y_i = y_0 + k_i step, k_i whole numbers (1)."""

from __future__ import annotations

import numpy as np

from flexarm.arrays import Floats

FEW = 8
"""Least number of different readings that show a grid."""


def quantisation_step(values: Floats, fewest: int = FEW) -> float:
    """Return the step of (1) of readings; 0 if they lie on no grid, or fewer than `fewest` differ.

    Those that are not finite are left out.
    """
    on_lattice = 0.02  # greatest distance of a reading from (1), in steps
    found = np.unique(np.round(values[np.isfinite(values)], 14))
    if len(found) < fewest:
        return 0.0
    step = float(np.diff(found).min())
    for _ in range(2):  # the first guess drifts over many steps
        count = np.round((found - found[0]) / step)
        step = float(count @ (found - found[0]) / (count @ count))
    away = np.abs((found - found[0]) / step - np.round((found - found[0]) / step))
    return step if away.max() < on_lattice else 0.0
