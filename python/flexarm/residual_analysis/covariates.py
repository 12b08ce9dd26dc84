r"""What a gap follows: how much of it a curve over each state of the motion explains.

With samples in groups g, such as the intervals of a state, and n_g of them in each,

    share = sum_g n_g mean_g^2 / sum_i y_i^2                                                         (1)

is the part of the squares that lies in the groups' means. Of it, c is in one constant; of the rest, which has
n - 1 freedoms, k groups explain

    r = (share - c)/(1 - c),      less what they get from noise:   1 - (1 - r) (n - 1)/(n - k)         (2)

A curve over any state explains a step, and two curves explain more than one, so states are tried in order of
how much they claim: the sign of a state, a curve over it, two curves (one for each sense of the motion) or
time. A claim must gain `GAIN` of the rest over those before it, and of the whole to have a name at all.

Time is given intervals no shorter than the motion's cycles: any slow gap follows finer ones.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats

Groups = NDArray[np.intp]

BINS = 25
"""Intervals of a curve over a state."""
SAMPLES = 12
"""Least samples an interval, on average."""
GAIN = 0.05
"""Share by which a state that claims more must explain more."""
CONSTANT = "a constant"


def curve_share(state: Floats, values: Floats, bins: int = BINS) -> float:
    """Share (1) of the squares of values, shape (n, k), in their means over intervals of a state."""
    return correlation_ratio(intervals(state, bins), values)


def intervals(state: Floats, bins: int) -> Groups:
    """Number of the interval, of `bins` equally wide ones, in which each sample of a state lies."""
    edges = np.linspace(state.min(), state.max(), bins + 1)
    return np.clip(np.digitize(state, edges) - 1, 0, bins - 1)


def correlation_ratio(groups: Groups, values: Floats) -> float:
    """Share (1) of the squares of values, shape (n, k), in the means of groups of samples."""
    count = np.bincount(groups)
    sums = np.stack([np.bincount(groups, column) for column in values.T], axis=1)
    explained = np.sum(sums[count > 0] ** 2 / count[count > 0, None])
    return float(explained / max(np.sum(values**2), 1e-300))  # eq. (1)


@dataclass(frozen=True)
class CovariateDependence:
    """What a gap follows.

    Attributes
    ----------
    beyond : dict of str to float
        Share of what is not constant, eq. (2), by what was tried, such as "angle of elbow".
    best : str
        What explains most, unless something simpler explains nearly as much.
    constant : float
        Share of the squares that lies in a constant.
    """

    beyond: Mapping[str, float]
    best: str
    constant: float

    @property
    def shares(self) -> dict[str, float]:
        """Share of all squares, the constant included."""
        rest = 1 - self.constant
        return {CONSTANT: self.constant} | {
            name: self.constant + rest * share for name, share in self.beyond.items()
        }

    @property
    def share(self) -> float:
        """Of the best."""
        return self.shares[self.best]

    def __str__(self) -> str:
        others = sorted(self.beyond, key=lambda name: -self.beyond[name])
        rest = ", ".join(
            f"{name} {100 * self.beyond[name]:.0f} %" for name in others[:3] if name != self.best
        )
        said = f"constant {100 * self.constant:.0f} %; the rest "
        if self.best == CONSTANT:
            return said + f"nothing much ({rest})"
        return said + f"{self.best} {100 * self.beyond[self.best]:.0f} % ({rest})"


def covariate_dependence(covariates: Mapping[str, tuple[int, Groups]], values: Floats) -> CovariateDependence:
    """What values follow best.

    Parameters
    ----------
    covariates : dict of str to (int, ndarray of int, shape (n,))
        By name: how much it claims, and the samples' groups.
    values : ndarray, shape (n, k)
        Over their noise.
    """
    rest = values - values.mean(axis=0)
    constant = 1 - float(np.sum(rest**2) / max(np.sum(values**2), 1e-300))
    beyond = {name: _adjusted(groups, rest) for name, (_, groups) in covariates.items()}
    best, most = CONSTANT, 0.0
    for claim in sorted({claim for claim, _ in covariates.values()}):
        first = max(
            (name for name in covariates if covariates[name][0] == claim), key=lambda name: beyond[name]
        )
        if beyond[first] > most + GAIN:
            best, most = first, beyond[first]
    return CovariateDependence(beyond, best if most * (1 - constant) > GAIN else CONSTANT, constant)


def _adjusted(groups: Groups, values: Floats) -> float:
    """Share (2) of values without their mean."""
    n, k = len(groups), len(np.unique(groups))
    if n <= k:
        return 0.0
    return max(0.0, 1.0 - (1.0 - correlation_ratio(groups, values)) * (n - 1) / (n - k))  # eq. (2)
