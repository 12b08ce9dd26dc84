"""Clocks: the stamp of a measurement as a function of its instant.

    stamp = t + rate (t - since) + delay                                                             (1)

t [s] is the time of the reference clock, `delay` how late the stamps are at the instant `since`, `rate` [s/s]
how much faster the clock runs. Delay and rate are those of the effects `time_delay` and `clock_drift`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter


@dataclass(frozen=True)
class ClockError:
    """Error of a clock with respect to the reference clock."""

    delay: float = 0.0
    """How late its stamps are [s]."""
    rate: float = 0.0
    """How much faster it runs [s/s]."""
    since: float = 0.0
    """When it is late by the delay alone [s]."""

    def __post_init__(self) -> None:
        if not np.isfinite(self.delay):
            raise InvalidParameter(f"delay of a clock must be finite, got {self.delay} s")
        if not abs(self.rate) < 1:
            raise InvalidParameter(f"rate of a clock must be between -1 and 1, got {self.rate} s/s")

    def stamps(self, instants: Floats) -> Floats:
        """Return the stamps of instants t, eq. (1)."""
        return instants + self.rate * (instants - self.since) + self.delay

    def instants(self, stamps: Floats) -> Floats:
        """Return the instants t of stamps, eq. (1) solved for t."""
        if not self.delay and not self.rate:
            return stamps
        return (stamps - self.delay + self.rate * self.since) / (1 + self.rate)

    def counted_from(self, since: float) -> ClockError:
        """Return the same clock with its delay at another instant [s]."""
        return replace(self, delay=self.delay + self.rate * (since - self.since), since=since)


EXACT = ClockError()
