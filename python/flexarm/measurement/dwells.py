"""Dwell detection: intervals of a drive in which noise explains all differences of the samples.

A motor at rest keeps its dry friction. One that follows its encoder's noise creeps to and fro by more than
the width of the friction law, and loses its friction within a second. With y in units of the noise, n samples
are a dwell if, about their mean and about their regression line of slope b,

    sum (y_i - mean)^2 <= chi-square limit, n - 1 degrees of freedom,    |b| / sigma_b <= `drift`     (1)

Dwells grow from blocks of `BLOCK` samples while (1) holds, and at last by the k samples before and after that
do not differ from their mean, |sum (y_i - mean)| <= `near` sqrt(k), less a few in which a motion may have
begun below the noise. Two of them between which the drive moves by less than `creep` sigma are not dwells:
an encoder of coarse steps shows a slow motion so.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats

Dwell = tuple[int, int]
"""First and last sample."""

BLOCK = 16
"""Samples."""


def find_dwells(time: Floats, scaled: Floats) -> list[Dwell]:
    """Return the dwells in their order, of samples over their noise, shape (n,), at rising times."""
    least = 4  # least blocks of a dwell; the top of a slow wave is shorter
    blocks = _Blocks(time, scaled)
    found: list[Dwell] = []
    begin, still = 0, blocks.still_for(least)
    while begin + least <= blocks.count:
        end = begin + still[begin]
        if still[begin] == least:
            end = blocks.grown(begin)
            found.append(_extended((begin * BLOCK, end * BLOCK - 1), scaled))
        begin = max(end, begin + 1)
    return _without_slow_motion(found, scaled)


class _Blocks:
    """Blocks of samples, from whose sums (1) follows for any sequence of them."""

    def __init__(self, time: Floats, scaled: Floats) -> None:
        from scipy.special import chdtri

        alarm = 1e-6  # probability that noise alone ends a dwell, eq. (1)
        self.count = len(time) // BLOCK
        n = self.count * BLOCK
        self._time, self._scaled = (each[:n].reshape(self.count, BLOCK) for each in (time, scaled))
        self._limit = chdtri(BLOCK * np.arange(1.0, self.count + 1) - 1, alarm)  # of 1, 2, ... blocks

    def still_for(self, most: int) -> list[int]:
        """Return for how many blocks from each on all lengths are a dwell, `most` at most."""
        begins = np.arange(max(self.count - most + 1, 0))
        if not len(begins):
            return []
        found: list[int] = np.cumprod(~self._moves(begins, most), axis=0).sum(axis=0).tolist()
        return found

    def grown(self, begin: int) -> int:
        """Return the end of the longest dwell from one block on, which is a dwell at all its lengths."""
        first_look = 32  # blocks of the first search; without influence on the result
        most = first_look  # most dwells are short: the searched length grows
        while True:
            here = min(most, self.count - begin)
            moves = self._moves(np.array([begin]), here)[:, 0]
            if moves.any():
                return begin + int(np.argmax(moves))
            if here == self.count - begin:
                return self.count
            most *= 4

    def _moves(self, begins: NDArray[np.intp], most: int) -> NDArray[np.bool_]:
        """Return True where 1 to `most` blocks are no dwell, by begin, shape (most, begins).

        Sums count from the first sample of a dwell: from that of the record they would cancel.
        """
        drift = 5.0  # greatest slope in its sigmas, eq. (1)
        blocks = begins + np.arange(most)[:, None]
        t = self._time[blocks] - self._time[begins, :1]
        y = self._scaled[blocks] - self._scaled[begins, :1]
        powers = np.stack([each.sum(axis=-1) for each in (t, t * t, y, y * y, t * y)])
        t, tt, y, yy, ty = np.cumsum(powers, axis=1)
        n = BLOCK * np.arange(1.0, most + 1)[:, None]
        scatter = yy - y * y / n
        spread = np.maximum(tt - t * t / n, 1e-300)
        slope = (ty - t * y / n) / np.sqrt(spread)
        found: NDArray[np.bool_] = (scatter > self._limit[:most, None]) | (np.abs(slope) > drift)  # eq. (1)
        return found


def _extended(dwell: Dwell, scaled: Floats) -> Dwell:
    """Extend a dwell into the blocks before and after, less `spared` samples at either end."""
    spared = 8  # samples at either end in which a motion may have begun below the noise
    near = 3.0  # greatest sum of the samples at an end, in its sigmas
    first, last = dwell
    level = np.mean(scaled[first : last + 1])

    def alike(samples: Floats) -> int:
        k = np.arange(1, len(samples) + 1)
        far = np.abs(np.cumsum(samples - level)) > near * np.sqrt(k)
        return int(np.argmax(far)) if far.any() else len(samples)

    before = alike(scaled[max(first - BLOCK, 0) : first][::-1])
    after = alike(scaled[last + 1 : last + 1 + BLOCK])
    begin, end = first - before, last + after
    return begin + spared * (begin > 0), end - spared * (end < len(scaled) - 1)


def _without_slow_motion(found: list[Dwell], scaled: Floats) -> list[Dwell]:
    creep = 20.0  # least motion between two dwells, in sigmas of a sample
    level = [float(np.mean(scaled[first : last + 1])) for first, last in found]
    creeps = [False] * len(found)
    for k in range(len(found) - 1):
        between = scaled[found[k][1] + 1 : found[k + 1][0]]
        far = max(np.abs(between - level[k]).max(initial=0.0), abs(level[k + 1] - level[k]))
        if far < creep:
            creeps[k] = creeps[k + 1] = True
    return [dwell for dwell, creeping in zip(found, creeps, strict=True) if not creeping]
