"""Pairs of effects that an experiment would leave tied."""

from __future__ import annotations

from math import inf

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.diagnosis.choosing.acceptance import REACH, STRONG


def ties(factors: Floats, seen: Floats) -> NDArray[np.bool_]:
    """Which pairs are tied: one of them is seen, and the other would do in its place."""
    count = len(seen)
    found = np.zeros((count, count), dtype=bool)
    for i in range(count):
        for j in range(i):
            found[i, j] = found[j, i] = lesser_factor(factors, seen, i, j) < REACH
    return found


def lesser_factor(factors: Floats, seen: Floats, i: int, j: int) -> float:
    """The lesser one of E ln B_ij and E ln B_ji, of those whose effect is seen at all."""
    both = [factors[a, b] for a, b in ((i, j), (j, i)) if seen[a] >= STRONG]
    return float(min(both, default=inf))


def pairs(tied: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """The pairs that are tied, each once."""
    return [(int(i), int(j)) for i, j in np.argwhere(np.triu(tied, 1))]
