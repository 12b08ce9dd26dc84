r"""Carrier and oscillations: the part that follows the arm's pose, and the part that vibrates.

Oscillations are what a Butterworth filter of order 3, forward and backward, lets pass above

    f_c = f_1/2                                                                                       (1)

f_1 [Hz]: first mode in the plane of motion. The sine is a hundred times as slow, the first mode is twice f_c.
A free vibration of the first mode falls to a thousandth within

    T = ln(1000)/(2π ζ_1 f_1)                                                                         (2)
"""

from __future__ import annotations

from math import log, pi

import numpy as np

from flexarm.arrays import Floats
from flexarm.reproduction.study import Study

GRID = 2e-2
"""Step of curves that are drawn and filtered [s]: 20 samples a period of the first mode."""


def grid(study: Study) -> Floats:
    """Return equal steps over the run [s]."""
    return np.arange(round(study.experiment.end / GRID) + 1, dtype=float) * GRID


def oscillation(values: Floats, rate_hz: float, study: Study) -> Floats:
    """Return the part above (1) of equally spaced values."""
    from scipy.signal import butter, sosfiltfilt

    cut = study.frequency_hz["fe"] / 2  # eq. (1)
    found: Floats = sosfiltfilt(butter(3, cut, "highpass", fs=rate_hz, output="sos"), values)
    return found


def start_time(study: Study) -> float:
    """Return T of (2) [s]: after it nothing is left of the start."""
    return log(1000) / (2 * pi * study.damping_ratio["fe"] * study.frequency_hz["fe"])  # eq. (2)


def rms(values: Floats) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def length_rms(values: Floats) -> float:
    """Return the root mean square of the lengths of vectors, shape (n, 2)."""
    return rms(np.hypot(values[:, 0], values[:, 1]))
