"""Knot placement at rest: a drive's spline is constant in dwells and monotone on either side of them.

A dwell has no breaks within, and close ones on either side, since a motion starts there at once. A dwell is
kept if chi-square, there and `AROUND` it, does not separate the fit with it from the fit without:

    chi2 - chi2_free < limit + m + 5 sqrt(2 m),    m coefficients less                              (1)

Close breaks also follow the noise, and a motor that reverses by a few of its encoder's sigmas before it stops
loses its dry friction. The coefficients from a dwell to the first one that is `near` sigmas away are
therefore made monotone: neighbours that break monotonicity are made equal, until none are left. A real
overshoot fails (1) and stays.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.measurement.dwells import Dwell, find_dwells
from flexarm.measurement.least_squares_spline import Indices, constant_in, fit_spline

AROUND = 64
"""Samples before and after a dwell that test it."""
NEXT_TO = np.array([2, 4, 6, 8, 10, 12, 14, 16, 20, 24, 32])
"""Samples from the end of a dwell to the breaks next to it."""


def place_knots_at_rest(time: Floats, scaled: Floats, breaks: Indices) -> tuple[Indices, frozenset[int]]:
    """Return the breaks of a spline that is constant in dwells, and its equal coefficients."""
    found = find_dwells(time, scaled)
    if not found:
        return breaks, frozenset()
    held, standing = _parted(breaks, found)
    misfit = _Misfit(time, scaled, breaks, frozenset())
    still = _Misfit(time, scaled, held, constant_in(standing))
    kept = []
    for first, last in found:
        begin, end = first - AROUND, last + AROUND
        fewer = int(np.count_nonzero((breaks >= begin) & (breaks <= end))) + 1
        if still.of(begin, end) - misfit.of(begin, end) < _allowed(fewer):  # eq. (1)
            kept.append((first, last))
    breaks, standing = _parted(breaks, kept)
    return breaks, _monotone_next_to_dwells(time, scaled, breaks, standing)


def _allowed(fewer: int) -> float:
    limit = 25.0  # of (1): 5 sigma of one degree of freedom
    return limit + fewer + 5 * float(np.sqrt(2 * fewer))  # eq. (1)


class _Misfit:
    """A fit, and its chi-square between samples."""

    def __init__(self, time: Floats, scaled: Floats, breaks: Indices, equal: frozenset[int]) -> None:
        spline, fitted = fit_spline(time, scaled, breaks, equal=equal)
        self.coefficients = spline.c
        self._sums = np.concatenate([[0.0], np.cumsum((scaled - fitted) ** 2)])

    def of(self, begin: int, end: int) -> float:
        last = len(self._sums) - 1
        return float(self._sums[min(end + 1, last)] - self._sums[max(begin, 0)])


def _monotone_next_to_dwells(
    time: Floats, scaled: Floats, breaks: Indices, standing: Sequence[int]
) -> frozenset[int]:
    """Return the equal coefficients of a spline that is monotone next to its dwells, where (1) allows it."""
    held = constant_in(standing)
    free = _Misfit(time, scaled, breaks, held)
    sides = [side for k in standing for side in _outwards(free.coefficients, k)]
    equal: list[set[int]] = [set() for _ in sides]
    while True:
        now = _Misfit(time, scaled, breaks, held.union(*equal))
        turning = [
            _breaking_monotonicity(now.coefficients, side) - same
            for side, same in zip(sides, equal, strict=True)
        ]
        if not any(turning):
            break
        for same, more in zip(equal, turning, strict=True):
            same |= more
    for same in filter(None, equal):
        begin = breaks[max(min(same) - 3, 0)] - AROUND
        end = breaks[min(max(same), len(breaks) - 1)] + AROUND
        if now.of(begin, end) - free.of(begin, end) >= _allowed(len(same)):
            same.clear()
    return held.union(*equal)


def _outwards(coefficients: Floats, interval: int) -> Iterator[list[int]]:
    """Yield the coefficients from a dwell outwards to the first that is `near` away, before and after it."""
    near = 20.0  # sigmas within which a motion does not reverse next to a dwell
    level = coefficients[interval]
    for outwards in (range(interval, -1, -1), range(interval + 3, len(coefficients))):
        far = next((k for k in outwards if abs(coefficients[k] - level) > near), None)
        if far is not None:
            yield list(range(outwards[0], far + outwards.step, outwards.step))


def _breaking_monotonicity(coefficients: Floats, outwards: Sequence[int]) -> set[int]:
    """Return the indices that break monotonicity."""
    way = np.sign(coefficients[outwards[-1]] - coefficients[outwards[0]])
    return {max(a, b) for a, b in pairwise(outwards) if way * (coefficients[b] - coefficients[a]) < 0}


def _parted(breaks: Indices, standing: Sequence[Dwell]) -> tuple[Indices, tuple[int, ...]]:
    """Return breaks at the ends of dwells, none within and close ones outside, and the constant intervals.

    Dwells in which the spline hardly has breaks are left out: there it cannot creep.
    """
    keep: NDArray[np.bool_] = np.zeros(breaks[-1] + 1, dtype=bool)
    keep[breaks] = True
    held = [(first, last) for first, last in standing if np.count_nonzero(keep[first : last + 1]) > 2]
    for first, last in held:
        sides = np.concatenate([[first, last], first - NEXT_TO, last + NEXT_TO])
        sides = sides[(sides > 1) & (sides < len(keep) - 2)]
        keep[sides - 1] = keep[sides + 1] = False  # breaks are at least two samples apart
        keep[sides] = True
    for first, last in held:
        keep[first : last + 1] = False
        keep[[first, last]] = True
    keep[[0, -1]] = True
    found = np.flatnonzero(keep)
    middles = [(first + last) // 2 for first, last in held]
    return found, tuple(int(k) for k in np.searchsorted(found, middles, side="right") - 1)
