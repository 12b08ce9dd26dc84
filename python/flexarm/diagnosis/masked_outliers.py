"""Rows that stand alone in what a model leaves: outliers that the gap had hidden.

While nobody knows what the model lacks, a reading is an outlier only if it stands out of the whole gap
(`validation.outliers`). Beside a model that explains the gap what is left is noise, and r_i is a stray if it
is off the median m_i of its seven neighbours by

    |r_i - m_i| > outlier max(sigma, s),   s = 1.48 median |r - m|                                      (1)

and by more than twice what most rows around it are. Of white noise one row in ten millions is. Torques,
accelerations and strains jump by themselves where teeth strike: of those a stray is besides beyond twice the
range of all others. A fit that squares strays leaves a gap where there is none; they are left out, as a loss
would that rejects [Huber1981], if without them nothing is left. Of what a model leaves that does not explain
the gap nothing is taken. What is held out loses its strays beside the repaired model.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.diagnosis.acceptance import Criteria
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.problem import Problem
from flexarm.measurement.outliers import SMOOTH, beyond_range_of_others, deviation_from_median, nearby
from flexarm.record import Record

AROUND = 2.0
"""How far a stray is off, over what most rows around it are."""
MOST = 0.15
"""Of the rows of a channel: where more are off, that is what the channel does."""


def strays(rest: Floats, problem: Problem) -> NDArray[np.bool_]:
    """Rows of motions that are strays by (1) in what a model leaves, shape (n,)."""
    found = np.zeros(len(problem), dtype=bool)
    for each, where in problem.channels():
        record = problem.records[each.record]
        if record.kind == "static":
            continue
        values = rest[where][:, None]
        rows, off, usual = deviation_from_median(values)
        if not len(rows):
            continue
        size = np.abs(off)
        least = problem.policy.outlier
        far = ((size > least * np.maximum(1.0, usual)) & (size > AROUND * nearby(size)))[:, 0]  # eq. (1)
        if far.any() and record.signals[each.signal].quantity not in SMOOTH:
            far &= beyond_range_of_others(values, far)
        if far.mean() < MOST:
            found[where.start + rows] = far
    return found


def hidden_strays(best: Fit, criteria: Criteria) -> NDArray[np.bool_]:
    """Strays without which a model leaves no gap; none where it leaves none anyhow, or one all the same."""
    problem = criteria.problem
    nothing = np.zeros(len(problem), dtype=bool)
    if not criteria.leaves_gap(best):
        return nothing
    found = strays(best.projected, problem)
    rest = best.projected.copy()
    rest[np.flatnonzero(found)] = 0.0
    return nothing if criteria.leaves_gap(replace(best, projected=rest)) else found


def left_out(records: Mapping[str, Record], out: NDArray[np.bool_], problem: Problem) -> dict[str, Record]:
    """Return records without the readings of a mask of rows, in all their channels."""
    found = dict(records)
    for each, where in problem.channels():
        record = found[each.record]
        values = record.signals[each.signal].values.copy()
        values[np.flatnonzero(each.kept)[out[where]]] = np.nan
        signal = replace(record.signals[each.signal], values=values)
        found[each.record] = replace(record, signals={**record.signals, each.signal: signal})
    return found


def strays_told(found: NDArray[np.bool_], problem: Problem) -> list[str]:
    """Return a sentence for each signal of a record that has some."""
    counts: dict[tuple[str, str], int] = {}
    for each, where in problem.channels():
        key = (each.signal, each.record)
        counts[key] = counts.get(key, 0) + int(found[where].sum())
    return [
        f"{count} value{'s' * (count > 1)} of {signal} in {record} left out: outliers that the gap had hidden"
        for (signal, record), count in counts.items()
        if count
    ]
