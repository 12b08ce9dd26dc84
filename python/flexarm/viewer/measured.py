"""Measured positions of points beside a run: what was measured minus what the model predicts, base axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexarm.arrays import Floats
from flexarm.comparison.aligned_record import AlignedRecord


@dataclass(frozen=True)
class Measured:
    """One position signal."""

    name: str
    point: str
    """Of the signal, and the point that it sees."""
    time: Floats
    """Instants of the run [s], shape (n,)."""
    away: Floats
    """Measured minus predicted along base axes; 0 along axes that were not measured, NaN at drop-outs [m],
    shape (n, 3)."""
    note: str = ""
    """What was not measured."""

    def gap(self, time: Floats) -> Floats:
        """Return it at other instants [m], shape (m, 3): joined by lines, NaN where rows are missing."""
        apart = 2.5  # median intervals between rows beyond which nothing is drawn between them
        known = np.isfinite(self.away).all(axis=1)
        at, away = self.time[known], self.away[known]
        if len(at) < 2:
            return np.full((len(time), 3), np.nan)
        found = np.stack([np.interp(time, at, column, np.nan, np.nan) for column in away.T], axis=1)
        after = np.clip(np.searchsorted(at, time), 1, len(at) - 1)
        found[at[after] - at[after - 1] > apart * float(np.median(np.diff(at)))] = np.nan
        return found


def measured_points(pair: AlignedRecord) -> list[Measured]:
    """Return the position signals of a record, clocks and frames as aligned."""
    placement, found = pair.aligned.placement, []
    for name, signal in pair.simulated.evidence.items():
        if signal.quantity != "position" or signal.point is None:
            continue
        axes = pair.simulated.axes(signal, placement)
        away = pair.simulated.residual(signal, placement) @ axes.T
        missing = [axis for axis in "xyz" if axis not in (signal.axes or "xyz")]
        note = f"{name} was not measured along {', '.join(missing)}" if missing else ""
        found.append(Measured(name, signal.point, pair.simulated.instants(signal, placement), away, note))
    return found
