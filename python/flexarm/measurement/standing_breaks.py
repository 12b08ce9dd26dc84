"""Breaks of a drive's spline that let it stand where its samples stand, and leave there as the motion does.

Within a stand there are none; beside it they are close, since a motion starts there at once. A stand is kept
if chi-square, there and `AROUND` it, does not tell the fit with it from the fit without:

    chi2 - chi2_free < LIMIT + m + 5 sqrt(2 m),    m breaks less                                      (1)
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.measurement.least_squares_spline import Indices, fit_spline
from flexarm.measurement.standstill import Stand, stands

LIMIT = 25.0
"""Of (1): 5 sigma of one degree of freedom."""
AROUND = 64
"""Samples before and after a stand that tell whether it is one."""
BESIDE = np.array([4, 8, 12, 16, 24, 32])
"""Samples from a stand's end to the breaks beside it."""


def with_stands(time: Floats, scaled: Floats, breaks: Indices) -> tuple[Indices, tuple[int, ...]]:
    """Breaks of a spline that stands where samples over their noise do, and its intervals that stand."""
    found = stands(time, scaled)
    if not found:
        return breaks, ()
    held, standing = _parted(breaks, found)
    free = (scaled - fit_spline(time, scaled, breaks)[1]) ** 2
    more = np.cumsum((scaled - fit_spline(time, scaled, held, standing=standing)[1]) ** 2 - free)
    kept = []
    for first, last in found:
        begin, end = max(first - AROUND, 0), min(last + AROUND, len(time) - 1)
        fewer = np.count_nonzero((breaks >= begin) & (breaks <= end)) + 1
        if more[end] - more[begin] < LIMIT + fewer + 5 * np.sqrt(2 * fewer):  # eq. (1)
            kept.append((first, last))
    return _parted(breaks, kept)


def _parted(breaks: Indices, standing: Sequence[Stand]) -> tuple[Indices, tuple[int, ...]]:
    """Breaks at the ends of stands, none within, close ones beside, and the intervals that stand then.

    Not of stands in which the spline hardly has breaks: there it cannot creep.
    """
    keep: NDArray[np.bool_] = np.zeros(breaks[-1] + 1, dtype=bool)
    keep[breaks] = True
    held = [(first, last) for first, last in standing if np.count_nonzero(keep[first : last + 1]) > 2]
    for first, last in held:
        beside = np.concatenate([[first, last], first - BESIDE, last + BESIDE])
        beside = beside[(beside > 1) & (beside < len(keep) - 2)]
        keep[beside - 1] = keep[beside + 1] = False  # breaks are at least two samples apart
        keep[beside] = True
    for first, last in held:
        keep[first : last + 1] = False
        keep[[first, last]] = True
    keep[[0, -1]] = True
    found = np.flatnonzero(keep)
    middles = [(first + last) // 2 for first, last in held]
    return found, tuple(int(k) for k in np.searchsorted(found, middles, side="right") - 1)
