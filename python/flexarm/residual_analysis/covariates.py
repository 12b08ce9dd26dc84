r"""Dependence of a residual on states of the motion, by correlation ratios.

The correlation ratio of y is the share of its squares that lies in the means of groups g of n_g samples, such
as the intervals of a state:

    eta^2 = sum_g n_g mean_g^2 / sum_i y_i^2                                                         (1)

A constant explains c of the squares. Of the rest, y less its mean with n - 1 degrees of freedom, k groups
explain, less what they explain of noise,

    r = 1 - (1 - eta^2) (n - 1)/(n - k)                                                              (2)

A curve over any state explains a step, and two curves explain more than one. Covariates are therefore tried
in order of complexity: 1 the sign of a state, 2 a curve over it, 3 two curves (one for each sense of the
motion) or time. A more complex covariate must gain `covariate_gain` over the simpler ones, and explain as
much of the whole.
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
    """Return the number of the interval, of `bins` equally wide ones, in which each sample lies."""
    edges = np.linspace(state.min(), state.max(), bins + 1)
    return np.clip(np.digitize(state, edges) - 1, 0, bins - 1)


def correlation_ratio(groups: Groups, values: Floats) -> float:
    """Return the share (1) of the squares of values, shape (n, k), in the means of groups of samples."""
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
        """Share of all squares that the best covariate explains, the constant included."""
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
    """Return the dependence of values over their noise, shape (n, k), on covariates."""
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
