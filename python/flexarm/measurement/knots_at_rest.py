"""A drive's spline that stands where its samples stand, and comes to rest and leaves without turning back.

Within a stand there are no breaks; beside it they are close, since a motion starts there at once. A stand is
kept if chi-square, there and `AROUND` it, does not tell the fit with it from the fit without:

    chi2 - chi2_free < LIMIT + m + 5 sqrt(2 m),    m coefficients less                              (1)

Close breaks follow the noise too, and a motor that turns back by a few of its encoder's sigmas before it
stands has lost the dry friction that it stands with. So the coefficients from a stand to the first one that
is `NEAR` sigmas away are made to rise or fall all the way: neighbours that do not are made equal, until none
are left. An overshoot that is there fails (1) and stays.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.measurement.dwells import Dwell, find_dwells
from flexarm.measurement.least_squares_spline import Indices, constant_in, fit_spline

LIMIT = 25.0
"""Of (1): 5 sigma of one degree of freedom."""
AROUND = 64
"""Samples before and after a stand that tell whether it is one."""
BESIDE = np.array([2, 4, 6, 8, 10, 12, 14, 16, 20, 24, 32])
"""Samples from a stand's end to the breaks beside it."""
NEAR = 20.0
"""Sigmas within which a motion does not turn back beside a stand."""


def place_knots_at_rest(time: Floats, scaled: Floats, breaks: Indices) -> tuple[Indices, frozenset[int]]:
    """Breaks of a spline that stands where samples over their noise do, and its equal coefficients."""
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
    return breaks, _without_turning_back(time, scaled, breaks, standing)


def _allowed(fewer: int) -> float:
    return LIMIT + fewer + 5 * float(np.sqrt(2 * fewer))  # eq. (1)


class _Misfit:
    """A fit, and its chi-square between samples."""

    def __init__(self, time: Floats, scaled: Floats, breaks: Indices, equal: frozenset[int]) -> None:
        spline, fitted = fit_spline(time, scaled, breaks, equal=equal)
        self.coefficients = spline.c
        self._sums = np.concatenate([[0.0], np.cumsum((scaled - fitted) ** 2)])

    def of(self, begin: int, end: int) -> float:
        last = len(self._sums) - 1
        return float(self._sums[min(end + 1, last)] - self._sums[max(begin, 0)])


def _without_turning_back(
    time: Floats, scaled: Floats, breaks: Indices, standing: Sequence[int]
) -> frozenset[int]:
    """Equal coefficients of a spline that does not turn back beside its stands, where (1) allows it."""
    held = constant_in(standing)
    free = _Misfit(time, scaled, breaks, held)
    beside = [side for k in standing for side in _beside(free.coefficients, k)]
    equal: list[set[int]] = [set() for _ in beside]
    while True:
        now = _Misfit(time, scaled, breaks, held.union(*equal))
        turning = [_turning(now.coefficients, side) - same for side, same in zip(beside, equal, strict=True)]
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


def _beside(coefficients: Floats, interval: int) -> Iterator[list[int]]:
    """Coefficients from a stand outwards to the first that is `NEAR` away, before and after the stand."""
    level = coefficients[interval]
    for outwards in (range(interval, -1, -1), range(interval + 3, len(coefficients))):
        far = next((k for k in outwards if abs(coefficients[k] - level) > NEAR), None)
        if far is not None:
            yield list(range(outwards[0], far + outwards.step, outwards.step))


def _turning(coefficients: Floats, outwards: Sequence[int]) -> set[int]:
    """The later one of any two neighbours of which the outer one is not as far out as the inner one."""
    way = np.sign(coefficients[outwards[-1]] - coefficients[outwards[0]])
    return {max(a, b) for a, b in pairwise(outwards) if way * (coefficients[b] - coefficients[a]) < 0}


def _parted(breaks: Indices, standing: Sequence[Dwell]) -> tuple[Indices, tuple[int, ...]]:
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
