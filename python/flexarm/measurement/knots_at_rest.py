"""Knot placement at rest: a drive's spline is constant in dwells and monotone on either side of them.

A dwell has no breaks within. A motion may start beside it at once, or so slowly that noise hides it for long,
and detection then takes its beginning for a part of the dwell. On either side of a dwell the first break is
therefore d samples from its end, d = 2, 4, 8, ..., and of d > 2 the dwell ends d samples earlier. Taken is
the d of the least

    chi2 + m ln n                                                                                    (1)

with m coefficients in the n samples around [Schwarz1978]: close breaks follow the noise as well, and what
starts gently is accelerated by it in jerks.

A dwell is kept if chi-square, there and `AROUND` it, does not separate the fit with it from the fit without:

    chi2 - chi2_free < limit + m + 5 sqrt(2 m),    m coefficients less                              (2)

A motor that reverses by a few of its encoder's sigmas before it stops loses its dry friction. The
coefficients from a dwell to the first one that is `near` sigmas away are therefore made monotone: neighbours
that break monotonicity are made equal, until none are left. A real overshoot fails (2) and stays.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.measurement.dwells import Dwell, find_dwells
from flexarm.measurement.least_squares_spline import Indices, constant_in, fit_spline

AROUND = 64
"""Samples before and after a dwell that test it."""
NEXT_TO = np.array([1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 16])
"""From the end of a dwell to the breaks next to it, over d."""
CLOSEST = 2
"""Least d [samples]: a break has two samples on either side."""

Equal = list[set[int]]
"""Equal coefficients on each side of the dwells, before and after them in turn."""


def place_knots_at_rest(time: Floats, scaled: Floats, breaks: Indices) -> tuple[Indices, frozenset[int]]:
    """Return the breaks of a spline that is constant in dwells, and its equal coefficients."""
    found = [  # where a spline hardly has breaks it cannot creep
        (first, last)
        for first, last in find_dwells(time, scaled)
        if np.count_nonzero((breaks >= first) & (breaks <= last)) > 2
    ]
    if not found:
        return breaks, frozenset()
    free = _Misfit(time, scaled, breaks, frozenset())
    parted, standing = _parted(breaks, found, _closest(found))
    still = _Misfit(time, scaled, parted, constant_in(standing))
    dwells = []
    for first, last in found:
        begin, end = first - AROUND, last + AROUND
        fewer = int(np.count_nonzero((breaks >= begin) & (breaks <= end))) + 1
        if still.of(begin, end) - free.of(begin, end) < _allowed(fewer):  # eq. (2)
            dwells.append((first, last))
    if not dwells:
        return breaks, frozenset()
    sides = _sides_without_overshoot(time, scaled, *_parted(breaks, dwells, _closest(dwells)))
    parted, standing = _parted(breaks, dwells, _distances(time, scaled, breaks, dwells, sides))
    equal = _made_monotone(time, scaled, parted, standing, sides)
    return parted, constant_in(standing).union(*equal)


def _closest(dwells: Sequence[Dwell]) -> list[int]:
    return [CLOSEST] * (2 * len(dwells))


def _allowed(fewer: int) -> float:
    limit = 25.0  # of (2): 5 sigma of one degree of freedom
    return limit + fewer + 5 * float(np.sqrt(2 * fewer))  # eq. (2)


class _Misfit:
    """A fit, and its chi-square between samples."""

    def __init__(self, time: Floats, scaled: Floats, breaks: Indices, equal: frozenset[int]) -> None:
        spline, fitted = fit_spline(time, scaled, breaks, equal=equal)
        self.coefficients = spline.c
        self._sums = np.concatenate([[0.0], np.cumsum((scaled - fitted) ** 2)])

    def of(self, begin: int, end: int) -> float:
        last = len(self._sums) - 1
        return float(self._sums[min(end + 1, last)] - self._sums[max(begin, 0)])


def _distances(
    time: Floats, scaled: Floats, breaks: Indices, dwells: Sequence[Dwell], sides: Collection[int]
) -> list[int]:
    """Return d on each side of the dwells, by (1)."""
    ends = [end for dwell in dwells for end in dwell]
    spans = np.diff([0, *ends, breaks[-1]])  # before, in, between, ..., and after the dwells
    # of a side, the shorter one of the motion there and the dwell itself
    room = [min(spans[side + side % 2], spans[side // 2 * 2 + 1]) for side in range(len(ends))]
    widest = [2 ** int(np.log2(max(each, 4 * CLOSEST) / 4)) for each in room]
    best: list[tuple[float, int]] = [(np.inf, CLOSEST)] * len(ends)
    distance = CLOSEST
    while distance <= max(widest):
        tried = [min(distance, most) for most in widest]
        parted, standing = _parted(breaks, dwells, tried)
        equal = _made_monotone(time, scaled, parted, standing, sides)
        misfit = _Misfit(time, scaled, parted, constant_in(standing).union(*equal))
        for side, (end, most) in enumerate(zip(ends, widest, strict=True)):
            reach = max(2 * most, AROUND)
            begin, stop = (end - AROUND, end + reach) if side % 2 else (end - reach, end + AROUND)
            count = np.count_nonzero((parted >= begin) & (parted <= stop))
            score = misfit.of(begin, stop) + count * float(np.log(AROUND + reach))  # eq. (1)
            if distance <= most and score < best[side][0]:
                best[side] = (score, distance)
        distance *= 2
    return [distance for _, distance in best]


def _sides_without_overshoot(
    time: Floats, scaled: Floats, breaks: Indices, standing: Sequence[int]
) -> frozenset[int]:
    """Return the sides of the dwells on which (2) allows a monotone spline."""
    held = constant_in(standing)
    sides = frozenset(range(2 * len(standing)))
    free = _Misfit(time, scaled, breaks, held)
    equal = _made_monotone(time, scaled, breaks, standing, sides)
    now = _Misfit(time, scaled, breaks, held.union(*equal))

    def overshoots(same: set[int]) -> bool:
        begin = breaks[max(min(same) - 3, 0)] - AROUND
        end = breaks[min(max(same), len(breaks) - 1)] + AROUND
        return now.of(begin, end) - free.of(begin, end) >= _allowed(len(same))

    return frozenset(side for side, same in enumerate(equal) if not same or not overshoots(same))


def _made_monotone(
    time: Floats, scaled: Floats, breaks: Indices, standing: Sequence[int], sides: Collection[int]
) -> Equal:
    """Return the coefficients that are equal in a spline that is monotone on some sides of its dwells."""
    held = constant_in(standing)
    now = _Misfit(time, scaled, breaks, held)
    ways = [way for k in standing for way in _outwards(now.coefficients, k)]
    equal: Equal = [set() for _ in ways]
    while True:
        turning = [
            _breaking_monotonicity(now.coefficients, way) - same if side in sides else set()
            for side, (way, same) in enumerate(zip(ways, equal, strict=True))
        ]
        if not any(turning):
            return equal
        for same, more in zip(equal, turning, strict=True):
            same |= more
        now = _Misfit(time, scaled, breaks, held.union(*equal))


def _outwards(coefficients: Floats, interval: int) -> list[list[int]]:
    """Return the coefficients from a dwell outwards to the first that is `near` away, before and after it.

    None of a side without one.
    """
    near = 20.0  # sigmas within which a motion does not reverse next to a dwell
    level, found = coefficients[interval], []
    for outwards in (range(interval, -1, -1), range(interval + 3, len(coefficients))):
        far = next((k for k in outwards if abs(coefficients[k] - level) > near), None)
        found.append([] if far is None else list(range(outwards[0], far + outwards.step, outwards.step)))
    return found


def _breaking_monotonicity(coefficients: Floats, outwards: Sequence[int]) -> set[int]:
    """Return the indices that break monotonicity."""
    if not outwards:
        return set()
    way = np.sign(coefficients[outwards[-1]] - coefficients[outwards[0]])
    return {max(a, b) for a, b in pairwise(outwards) if way * (coefficients[b] - coefficients[a]) < 0}


def _parted(
    breaks: Indices, dwells: Sequence[Dwell], distances: Sequence[int]
) -> tuple[Indices, tuple[int, ...]]:
    """Return breaks at the ends of dwells and `distances` beside them, and the constant intervals."""
    keep: NDArray[np.bool_] = np.zeros(breaks[-1] + 1, dtype=bool)
    keep[breaks] = True
    held = []
    for k, dwell in enumerate(dwells):
        ends = []
        for end, way, d in zip(dwell, (-1, 1), distances[2 * k : 2 * k + 2], strict=True):
            if d > CLOSEST and 0 < end < breaks[-1]:
                end -= way * d
            ends.append(end)
            beside = NEXT_TO[NEXT_TO * d <= max(CLOSEST * NEXT_TO[-1], 2 * d)] * d
            sides = end + way * beside
            sides = sides[(sides > 1) & (sides < len(keep) - 2)]
            keep[max(end - d + 1, 0) : end + d] = False
            keep[sides - 1] = keep[sides + 1] = False  # breaks are at least two samples apart
            keep[sides] = True
        held.append((ends[0], ends[1]))
    for first, last in held:
        keep[first : last + 1] = False
        keep[[first, last]] = True
    keep[[0, -1]] = True
    found = np.flatnonzero(keep)
    middles = [(first + last) // 2 for first, last in held]
    return found, tuple(int(k) for k in np.searchsorted(found, middles, side="right") - 1)
