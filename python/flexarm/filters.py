"""Digital filters; `scipy.signal`, which has them too, takes longer to import than they take."""

from __future__ import annotations

import numpy as np

from flexarm.arrays import Floats


def recursive_filter(values: Floats, poles: Floats) -> Floats:
    """Return y with poles[0] y_n + poles[1] y_(n-1) + ... = x_n, from rest, for x of shape (n, ...)."""
    from scipy.linalg.lapack import dtbtrs

    if not values.size:  # LAPACK writes beyond an array without columns
        return values.copy()
    band = np.repeat(np.asarray(poles, dtype=float)[:, None], len(values), axis=1)
    found, _ = dtbtrs(band[: len(values)], values.reshape(len(values), -1), uplo="L")
    return np.asarray(found).reshape(values.shape)


def cubic_average(values: Floats, window: int) -> Floats:
    """Return the values at each row of the cubic nearest to a window of rows around it [Savitzky1964].

    At both ends it is the cubic of the first and of the last window. Values have shape (n, ...), n >= window.
    """
    from scipy.ndimage import correlate1d

    half = window // 2
    powers = np.vander(np.linspace(-1.0, 1.0, window), 4)
    nearest = powers @ np.linalg.pinv(powers)
    found: Floats = correlate1d(values, nearest[half], axis=0)
    found[:half] = np.tensordot(nearest[:half], values[:window], 1)
    found[-half:] = np.tensordot(nearest[-half:], values[-window:], 1)
    return found
