"""Clocks that jump: a delay that changes within a record.

    y = s p + sum a c - d H(t - T) dp/dt + e                                                           (1)

d is the step of the delay at the time T, H Heaviside's step, the rest as in
`checks.regression`. A step is said if it takes away `EXPLAINED` of the squares of e for one
of the channels of that clock; a missing effect acts before T as after it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexarm.diagnosis.checks.channel import Channel, channels
from flexarm.diagnosis.checks.placing import placing
from flexarm.diagnosis.checks.plateaus import SLOW

if TYPE_CHECKING:
    from flexarm.comparison.subject import Subject

EXPLAINED = 0.8
SHORTEST = 3e-3
"""Steps of the delay that are said [s]."""
TIMES = 60
"""Instants T that are tried."""


def remarks_on_clocks(subjects: Mapping[str, Subject]) -> list[str]:
    """Steps of the delay of every clock in every record."""
    found = []
    for name, subject in subjects.items():
        if subject.record.kind == "static":
            continue
        best: dict[str, tuple[float, float, float, str]] = {}
        for channel in channels(name, subject, placing(subject)):
            clock = channel.signal.clock
            if channel.signal.quantity in SLOW and len(channel.rows) > 30:
                best[clock] = max(best.get(clock, (0.0, 0.0, 0.0, "")), _step(channel))
        found += [
            f"{name}: the clock {clock} jumps by {1e3 * step:.3g} ms near t = {at:.4g} s, as {label} shows"
            for clock, (share, step, at, label) in best.items()
            if share > EXPLAINED and abs(step) > SHORTEST
        ]
    return found


def _step(channel: Channel) -> tuple[float, float, float, str]:
    """Share of the squares that a step of the delay explains, the step [s], its time, the channel."""
    rate = channel.columns[:, -1]  # of a place or angle the last column is -dp/dt
    A = np.column_stack([channel.predicted, channel.columns])
    A = A[:, np.any(A != 0, axis=0)]
    Q = np.linalg.qr(A)[0]
    e = channel.measured - Q @ (Q.T @ channel.measured)
    whole = float(e @ e) or 1.0
    best = (0.0, 0.0, 0.0, channel.label)
    for at in np.linspace(channel.time[0], channel.time[-1], TIMES + 2)[2:-2]:
        late = np.where(channel.time > at, rate, 0.0)
        late = late - Q @ (Q.T @ late)
        size = float(late @ late)
        if size > 0:
            step = float(late @ e) / size
            best = max(best, (step**2 * size / whole, step, float(at), channel.label))
    return best
