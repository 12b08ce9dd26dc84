"""Samples so far off that they would pull an alignment: a tracker that caught a reflection, a broken word.

A row is an outlier if, in any channel, its residual differs from the median of its seven neighbours by more
than `NOISE` times the stated noise and more than `SPREAD` times the usual such difference (1.48 MAD). A gap
of the model is smoother than that, however large. Outliers are left out of the alignment only; the gap counts
them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

NEIGHBOURS = 7
NOISE, SPREAD = 100.0, 20.0


def outliers(residual: Floats, noise: float) -> NDArray[np.bool_]:
    """Rows of a residual that are outliers.

    Parameters
    ----------
    residual : ndarray, shape (n, channels)
        Measured minus predicted; NaN where there is no value.
    noise : float
        1 sigma of a channel, in the same unit.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    found = np.zeros(len(residual), dtype=bool)
    rows = np.flatnonzero(np.isfinite(residual).all(axis=1))
    if len(rows) <= NEIGHBOURS:
        return found
    from scipy.ndimage import median_filter

    values = residual[rows]
    off = np.abs(values - median_filter(values, size=(NEIGHBOURS, 1), mode="nearest"))
    usual = 1.48 * np.median(off, axis=0)
    found[rows] = np.any(off > np.maximum(NOISE * noise, SPREAD * usual), axis=1)
    return found
