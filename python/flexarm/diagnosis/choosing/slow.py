"""What is slow in residuals: moving averages, in which what rings hardly shows.

A mass or a stiffness that is far off shifts the frequency at which an arm rings, and within some periods the
model is out of step: to first order nothing explains that any more, least of all the right size of the right
effect. How the arm hangs, and what its motors bear, still follow in proportion.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexarm.arrays import Floats
from flexarm.diagnosis.residuals.observed import Observed

AVERAGED = 1.0
"""Length of the average [s]: a few periods of a heavy arm, a small part of its motion."""


def slow_part(observed: Observed) -> Callable[[Floats], Floats]:
    """Averages columns of residuals over `AVERAGED`, channel by channel; poses stay as they are."""
    windows = []
    for each, where in observed.channels():
        if observed.records[each.record].kind == "motion" and len(each.time) > 1:
            windows.append((where, round(AVERAGED / float(np.median(np.diff(each.time))))))

    def averaged(columns: Floats) -> Floats:
        from scipy.ndimage import uniform_filter1d

        found = columns.copy()
        for where, size in windows:
            if size > 1:
                found[where] = uniform_filter1d(columns[where], size, axis=0, mode="nearest")
        return found

    return averaged
