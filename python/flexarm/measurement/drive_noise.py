"""Noise of a drive, from its own samples.

A motion is smooth from sample to sample, so that third differences of its samples hold noise alone:

    var(y_{i+3} - 3 y_{i+2} + 3 y_{i+1} - y_i) = 20 sigma^2,    sigma = 1.4826 median |D^3 y| / sqrt(20)  (1)
"""

from __future__ import annotations

import numpy as np

from flexarm.arrays import Floats

LEAST_DIFFERENCES = 128
"""Fewer third differences tell no noise: the median of as many errs by a tenth."""


def drive_noise(samples: Floats) -> float | None:
    """Return 1 sigma of evenly spaced samples of a smooth motion by (1), shape (n,); None if they are few."""
    third = np.diff(samples, 3)
    third = third[np.isfinite(third)]
    if len(third) < LEAST_DIFFERENCES:
        return None
    return float(1.4826 * np.median(np.abs(third)) / np.sqrt(20))  # eq. (1)
