"""Breaks and penalty of a spline that passes what sparse breaks do and adds no oscillation of its own.

A least-squares spline with a break at every Delta errs by a wave of period Delta. The wave is far below the
noise of the samples, but it lasts, and rings a lightly damped mode of that frequency. Breaks are therefore
`FINER` times as dense, and jumps J_k of the third derivative at break k have a penalty,

    sum_i (y_i - s(t_i))^2 + sum_k w_k J_k^2 -> min,    w_k = n_k Delta_k^7 / (PASS^8 delta_k),       (1)

with n_k samples in Delta_k, and delta_k between dense breaks. This is the discrete form of the smoothing
spline whose penalty is the integral of s''''^2. Of an oscillation at omega it passes

    H(omega) = 1 / (1 + (omega / omega_c)^8),      omega_c = PASS / Delta.                              (2)

A filter adds no frequency to those of the motion. Intervals of few samples, and those that a dwell
constrains, are not divided and have no penalty.

Units: those of the samples, times in s. Source: [Wahba1990], section 2.1; [Eilers1996].
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from flexarm.arrays import Floats
from flexarm.measurement.least_squares_spline import DEGREE, Indices

FINER = 4
"""Dense breaks in the interval of a sparse one: their own wave is 1/256 as high."""
PASS = 3.5
"""Of (2): at pi as much noise passes as with sparse breaks; a little more keeps slow oscillations whole."""


def with_penalty(
    time: Floats, breaks: Indices, equal: Collection[int]
) -> tuple[Indices, frozenset[int], Floats]:
    """Return dense breaks, the equal coefficients of their spline, and the weights w of (1) at inner breaks.

    `time` [s], sparse `breaks` and `equal` coefficients are as of `least_squares_spline.fit_spline`.
    """
    counts = np.diff(breaks)
    parts = np.clip(counts // 2, 1, FINER)  # dense breaks are at least two samples apart
    for k in equal:
        parts[max(k - DEGREE - 1, 0) : k + 1] = 1
    added = np.concatenate([[0], np.cumsum(parts - 1)])
    moved = frozenset(int(k + added[max(k - DEGREE, 0)]) for k in equal)
    of = np.repeat(np.arange(len(counts)), parts)
    within = np.arange(len(of)) - np.repeat(np.cumsum(parts) - parts, parts)
    dense = np.append(breaks[of] + within * counts[of] // parts[of], breaks[-1])
    weight = counts[of] * np.diff(time[breaks])[of] ** 7 / (PASS**8 * np.diff(time[dense]))  # eq. (1)
    weight[parts[of] == 1] = 0.0
    return dense, moved, np.minimum(weight[:-1], weight[1:])
