"""Samples of a study: one row of parameters for each run.

Points u in the unit cube come from `scipy.stats.qmc` and pass through the quantile functions. For Sobol
indices by Saltelli's scheme two independent sets A and B come from one sequence of twice the dimension, and
AB_i is A with the column i of B, so that the rows are

    A, B, AB_1, ..., AB_d:  n (d + 2) runs                                                                (1)

Source: A. Saltelli et al., "Variance based sensitivity analysis of model output", Computer Physics
Communications 181 (2010), 259-270.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexarm.arrays import Floats
from flexarm.campaigns.study import Sampling


def samples(
    sampling: Sampling | None, distributions: Sequence[Distribution], levels: Sequence[int | None]
) -> Floats:
    """Return the values of all parameters, shape (runs, d); one row without sampling."""
    # Distance of a point from 0 and 1, half the resolution of Sobol points: a normal value stays finite.
    closest = 2.0**-33
    d = len(distributions)
    if sampling is None or not d:
        return np.zeros((1, 0))
    if sampling.method == "grid":
        axes = [each.levels(count) for each, count in zip(distributions, levels, strict=True)]
        return np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)
    u = np.clip(_points(sampling, 2 * d if sampling.saltelli else d), closest, 1 - closest)
    x = np.stack(
        [each.quantile(u[:, k]) for k, each in enumerate((*distributions, *distributions)[: u.shape[1]])], 1
    )
    return _swapped(x[:, :d], x[:, d:]) if sampling.saltelli else x


def _swapped(a: Floats, b: Floats) -> Floats:
    """Return the rows of (1)."""
    blocks = [a, b]
    for k in range(a.shape[1]):
        mixed = a.copy()
        mixed[:, k] = b[:, k]
        blocks.append(mixed)
    return np.concatenate(blocks)  # eq. (1)


def _points(sampling: Sampling, dimension: int) -> Floats:
    """Return points in the unit cube, shape (n, dimension)."""
    from scipy.stats import qmc

    rng, n = np.random.default_rng(sampling.seed), sampling.n or 1
    if sampling.method == "random":
        return rng.random((n, dimension))
    engine = qmc.Sobol if sampling.method == "sobol" else qmc.LatinHypercube
    with warnings.catch_warnings():  # a number that is no power of two is told as a remark on the study
        warnings.simplefilter("ignore", UserWarning)
        return np.asarray(engine(dimension, seed=rng).random(n))


@dataclass(frozen=True)
class Distribution:
    """A distribution of one parameter by its quantile function x(u) for u in (0, 1), with z that of N(0, 1).

        normal      x = m + s z(u)
        lognormal   x = exp(mu + t z(u)),  t^2 = ln(1 + s^2/m^2),  mu = ln m - t^2/2                       (2)
        uniform     x = a + (b - a) u
        loguniform  x = a (b/a)^u
        values      x = x_k,  k = floor(u K)

    m and s are mean and standard deviation of x itself, of the lognormal one too.
    """

    kind: str
    """Its name in a study."""
    numbers: tuple[float, ...]
    """Mean and standard deviation, ends, or the values."""

    def quantile(self, u: Floats) -> Floats:
        """Return x(u)."""
        from scipy.special import ndtri

        x = np.asarray(self.numbers)
        if self.kind == "values":
            found = x[np.minimum((u * len(x)).astype(int), len(x) - 1)]
        elif self.kind == "uniform":
            found = x[0] + (x[1] - x[0]) * u
        elif self.kind == "loguniform":
            found = x[0] * (x[1] / x[0]) ** u
        elif self.kind == "lognormal":
            variance = np.log1p((x[1] / x[0]) ** 2)  # eq. (2)
            found = np.exp(np.log(x[0]) - variance / 2 + np.sqrt(variance) * ndtri(u))
        else:
            found = x[0] + x[1] * ndtri(u)
        return np.asarray(found, dtype=float)

    def levels(self, count: int | None) -> Floats:
        """Return the values of a grid: equally spaced from end to end, or midpoints of equal probability."""
        if self.kind == "values" or count is None:
            return np.asarray(self.numbers)
        if self.kind in ("uniform", "loguniform") and count > 1:
            return self.quantile(np.linspace(0, 1, count))
        return self.quantile((np.arange(count) + 0.5) / count)

    @property
    def median(self) -> float:
        """x(1/2)."""
        return float(self.quantile(np.array([0.5]))[0])
