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
from flexarm.residual_analysis.policy import POLICY

Groups = NDArray[np.intp]
Covariates = Mapping[str, tuple[int, Groups]]
"""By name: complexity of the covariate, and the group of each sample."""

CONSTANT = "a constant"


def intervals(state: Floats, bins: int = 25) -> Groups:
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
    """Dependence of a residual on covariates."""

    adjusted: Mapping[str, float]
    """By covariate, such as "angle of elbow": share (2) of what is not constant."""
    best: str
    """The covariate that explains most, unless a simpler one explains nearly as much."""
    constant: float
    """Share of the squares in a constant."""

    @property
    def share(self) -> float:
        """Share of all squares that the best covariate explains, the constant included."""
        rest = 0.0 if self.best == CONSTANT else self.adjusted[self.best]
        return self.constant + (1 - self.constant) * rest

    @property
    def relevant(self) -> bool:
        """Return True if the best covariate explains enough of the squares to be named in a table."""
        return self.share >= POLICY.explained_share

    def __str__(self) -> str:
        shares = {name: f"{name} {100 * share:.0f} %" for name, share in self.adjusted.items()}
        ranked = sorted(self.adjusted, key=lambda name: -self.adjusted[name])
        others = ", ".join(shares[name] for name in ranked[:3] if name != self.best)
        best = shares.get(self.best, "nothing much")
        return f"constant {100 * self.constant:.0f} %; the rest {best} ({others})"


def covariate_dependence(covariates: Covariates, values: Floats) -> CovariateDependence:
    """Return the dependence of values over their noise, shape (n, k), on covariates."""
    n, rest = len(values), values - values.mean(axis=0)
    constant = 1 - float(np.sum(rest**2) / max(np.sum(values**2), 1e-300))
    adjusted = {}
    for name, (_, groups) in covariates.items():
        k = len(np.unique(groups))
        left = (1 - correlation_ratio(groups, rest)) * (n - 1) / (n - k) if n > k else 1.0
        adjusted[name] = max(0.0, 1 - left)  # eq. (2)
    best, most = CONSTANT, 0.0
    for complexity in sorted({complexity for complexity, _ in covariates.values()}):
        equals = [name for name, (each, _) in covariates.items() if each == complexity]
        first = max(equals, key=lambda name: adjusted[name])
        if adjusted[first] > most + POLICY.covariate_gain:
            best, most = first, adjusted[first]
    named = most * (1 - constant) > POLICY.covariate_gain
    return CovariateDependence(adjusted, best if named else CONSTANT, constant)
