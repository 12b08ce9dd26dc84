r"""Frequencies at which a gap swings, from samples at any instants.

The periodogram (`gap.periodogram`) of every channel over its noise, summed over channels. A tracker alone
cannot tell a frequency from its aliases about its sampling rate; beside a faster signal the sum can, as only
the true frequency is high in both. What moves with the drive, below `LOWEST`, is left out.
"""

from __future__ import annotations

import numpy as np

from flexarm.arrays import Floats
from flexarm.diagnosis.gap.periodogram import periodogram
from flexarm.diagnosis.residuals.observed import Observed

LOWEST, HIGHEST = 0.3, 15.0
"""Frequencies that are looked at [Hz]."""
FINE = 4.0
"""Frequencies a width of a peak, which is one over the length of the record."""


def rhythms(rest: Floats, observed: Observed, most: int = 3) -> list[float]:
    """The `most` frequencies [Hz] at which a residual swings most, the strongest first."""
    motions = [each for each in observed.rows if observed.records[each.record].kind == "motion"]
    length = observed.seconds
    if length <= 0:
        return []
    frequency = np.arange(LOWEST, HIGHEST, 1.0 / (FINE * length))
    power = np.zeros(len(frequency))
    for each in motions:
        values = rest[each.where]
        if len(values) > 8:
            power += len(values) * np.interp(frequency, *periodogram(each.time, values, 2 * FINE, HIGHEST))
    found: list[float] = []
    width = 2.0 / length
    for k in np.argsort(-power):
        if all(abs(frequency[k] - other) > width for other in found):
            found.append(float(frequency[k]))
        if len(found) == most:
            break
    return found
