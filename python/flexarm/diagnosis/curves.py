r"""What a gap follows: how much of it a curve over each state of the motion explains.

With samples in groups g, such as the intervals of a state, and n_g of them in each,

    share = sum_g n_g mean_g^2 / sum_i y_i^2,     1 - (1 - share) n/(n - k)                          (1)

is the part of the squares that lies in the groups' means, and the same without what k means get from nothing
but noise. A curve over any state explains a constant, and two curves explain more than one, so states are
tried in order of how much they claim: a constant, the sign of a state, a curve over it, two curves (one for
each sense of the motion). A claim must gain `GAIN` over those before it.

Time is given intervals no shorter than the motion's cycles: any slow gap follows finer ones.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Groups = NDArray[np.intp]

BINS = 25
"""Intervals of a curve over a state."""
SAMPLES = 12
"""Least samples an interval, on average."""
GAIN = 0.05
"""Share by which a state that claims more must explain more."""


def curve_share(state: Floats, values: Floats, bins: int = BINS) -> float:
    """Share (1) of the squares of values, shape (n, k), in their means over intervals of a state."""
    return group_share(intervals(state, bins), values)


def intervals(state: Floats, bins: int) -> Groups:
    """Number of the interval, of `bins` equally wide ones, in which each sample of a state lies."""
    edges = np.linspace(state.min(), state.max(), bins + 1)
    return np.clip(np.digitize(state, edges) - 1, 0, bins - 1)


def group_share(groups: Groups, values: Floats) -> float:
    """Share (1) of the squares of values, shape (n, k), in the means of groups of samples."""
    count = np.bincount(groups)
    sums = np.stack([np.bincount(groups, column) for column in values.T], axis=1)
    explained = np.sum(sums[count > 0] ** 2 / count[count > 0, None])
    return float(explained / max(np.sum(values**2), 1e-300))  # eq. (1)


@dataclass(frozen=True)
class Followed:
    """What a gap follows.

    Attributes
    ----------
    shares : dict of str to float
        Share of the squared gap by what was tried, such as "angle of elbow", less what noise gives.
    best : str
        What explains most, unless something simpler explains nearly as much.
    """

    shares: Mapping[str, float]
    best: str

    @property
    def share(self) -> float:
        """Of the best."""
        return self.shares.get(self.best, 0.0)


def followed(tiers: Mapping[str, tuple[int, Groups]], values: Floats) -> Followed:
    """What values follow best.

    Parameters
    ----------
    tiers : dict of str to (int, ndarray of int, shape (n,))
        By name: how much it claims, and the samples' groups.
    values : ndarray, shape (n, k)
        Over their noise.
    """
    shares = {name: _adjusted(groups, values) for name, (_, groups) in tiers.items()}
    best = ""
    for claim in sorted({claim for claim, _ in tiers.values()}):
        names = [name for name in tiers if tiers[name][0] == claim]
        first = max(names, key=lambda name: shares[name])
        if not best or shares[first] > shares[best] + GAIN:
            best = first
    return Followed(shares, best)


def _adjusted(groups: Groups, values: Floats) -> float:
    """Share (1) less what that many means get from noise."""
    n, k = len(groups), len(np.unique(groups))
    if n <= k:
        return 0.0
    return max(0.0, 1.0 - (1.0 - group_share(groups, values)) * n / (n - k))  # eq. (1)
