"""The grid of a profile: lines along r and z on which every block, patch and pad begins and ends.

Between two neighbouring breakpoints the grid is divided evenly. All blocks take their points from one grid,
so blocks that touch share points by construction.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from math import ceil

import numpy as np

from flexarm.arrays import Floats

#: Breakpoints closer than this part of the profile's size are one.
SAME = 1e-9


@dataclass(frozen=True)
class Lines:
    """Values of r or of z, rising."""

    values: Floats

    @classmethod
    def through(cls, breakpoints: Iterable[float], size: float, most: float) -> Lines:
        """Return lines through all breakpoints, at most `size` apart; `most` is the size of the profile."""
        points = _distinct(breakpoints, SAME * most)
        pieces = [
            np.linspace(a, b, max(1, ceil((b - a) / size * (1 - 1e-9))), endpoint=False)
            for a, b in pairwise(points)
        ]
        return cls(np.concatenate([*pieces, [points[-1]]]))

    def index(self, value: float) -> int:
        """Return the index of the line at a breakpoint."""
        return int(np.abs(self.values - value).argmin())

    def within(self, first: float, last: float) -> slice:
        """Return the slice of the lines between two breakpoints, both included."""
        return slice(self.index(first), self.index(last) + 1)

    def __len__(self) -> int:
        return len(self.values)


def _distinct(values: Iterable[float], tolerance: float) -> list[float]:
    kept: list[float] = []
    for value in sorted(values):
        if not kept or value - kept[-1] > tolerance:
            kept.append(value)
    return kept
