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

import numpy as np

from flexarm.arrays import Floats
from flexarm.campaigns.distributions import Distribution
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
