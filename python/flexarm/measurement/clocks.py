"""Clocks: what a stamp says about the instant of a measurement.

    stamp = (1 + rate) t + delay                                                                     (1)

t [s] is the time of the reference clock, `delay` how late the stamps are, `rate` [s/s] how much faster the
clock runs. Delay and rate are those of contract effects `time_delay` and `clock_drift`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexarm.errors import InvalidParameter

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class ClockError:
    """How a clock differs from the reference clock.

    Attributes
    ----------
    delay : float
        How late its stamps are [s].
    rate : float
        How much faster it runs [s/s].
    """

    delay: float = 0.0
    rate: float = 0.0

    def __post_init__(self) -> None:
        if not np.isfinite(self.delay):
            raise InvalidParameter(f"delay of a clock must be finite, got {self.delay} s")
        if not abs(self.rate) < 1:
            raise InvalidParameter(f"rate of a clock must be between -1 and 1, got {self.rate} s/s")

    def stamps(self, instants: Floats) -> Floats:
        """Stamps of the instants t, eq. (1)."""
        return (1 + self.rate) * instants + self.delay

    def instants(self, stamps: Floats) -> Floats:
        """Instants t of the stamps, eq. (1) solved for t."""
        return (stamps - self.delay) / (1 + self.rate)


EXACT = ClockError()
