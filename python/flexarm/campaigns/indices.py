"""Sobol indices: the part of a result's variance that each parameter explains.

From any independent samples, of y in M bins of equal probability of a parameter (each value, where it has
few), with n samples, bin means m_b, counts n_b and the mean m,

    eta^2 = sum n_b (m_b - m)^2 / sum (y - m)^2,  S = 1 - (1 - eta^2) (n - 1)/(n - M)                     (1)

is the first-order index less what chance gives it (epsilon squared); values below zero are chance. From
Saltelli's rows A, B and AB_i

    S_i = mean(f_B (f_AB_i - f_A)) / V,  T_i = mean((f_A - f_AB_i)^2) / (2 V)                             (2)

with f centred and V its variance over A and B: first-order and total index. Sources: T. L. Kelley, "An
unbiased correlation ratio measure", PNAS 21 (1935), 554-559; A. Saltelli et al., Computer Physics
Communications 181 (2010), 259-270, table 2 (b) and (f).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats

LEAST = 40
"""Samples below which (1) says nothing."""
MOST_BINS = 32
RESAMPLES = 200
"""Of the bootstrap from which intervals follow."""


@dataclass(frozen=True)
class Indices:
    """Indices of one result, an entry for each parameter.

    Attributes
    ----------
    first, total : ndarray, shape (d,)
        First-order and total index; total NaN where the samples do not tell it.
    first90, total90 : ndarray, shape (d, 2)
        Ends of their 90 % intervals.
    """

    first: Floats
    first90: Floats
    total: Floats
    total90: Floats


def from_samples(x: Floats, y: Floats, seed: int = 0) -> Indices | None:
    """Return first-order indices (1) of y given x, shape (n, d), or None if there are too few samples."""
    n, d = x.shape
    if n < LEAST or np.ptp(y) == 0:
        return None
    bins = [_bins(column) for column in x.T]
    rng = np.random.default_rng(seed)
    draws = [rng.integers(n, size=n) for _ in range(RESAMPLES)]
    first = np.array([_explained(each, y) for each in bins])
    spread = np.array([[_explained(each[draw], y[draw]) for draw in draws] for each in bins])
    unknown = np.full(d, np.nan)
    return Indices(first, _interval(spread, first), unknown, np.full((d, 2), np.nan))


def from_saltelli(f: Floats, seed: int = 0) -> Indices | None:
    """Return both indices (2) of the values of all rows, shape (d + 2, n); rows with a NaN are left out."""
    f = f[:, np.isfinite(f).all(axis=0)]
    if f.shape[1] < 8 or np.ptp(f[:2]) == 0:
        return None
    rng, n = np.random.default_rng(seed), f.shape[1]
    first, total = _swapped(f)
    draws = [_swapped(f[:, rng.integers(n, size=n)]) for _ in range(RESAMPLES)]
    spread = [np.array([draw[k] for draw in draws]).T for k in range(2)]
    return Indices(first, _interval(spread[0], first), total, _interval(spread[1], total))


def _bins(x: Floats) -> NDArray[np.intp]:
    """Return the bin of each sample."""
    values, which = np.unique(x, return_inverse=True)
    if len(values) <= MOST_BINS and len(values) < len(x) // 2:
        return which
    count = int(np.clip(np.sqrt(len(x)) / 2, 4, MOST_BINS))
    return np.argsort(np.argsort(x, kind="stable")) * count // len(x)


def _explained(bins: NDArray[np.intp], y: Floats) -> float:
    """Return S of (1)."""
    counts = np.bincount(bins)
    sums = np.bincount(bins, weights=y - y.mean())
    there = counts > 0
    whole = float(np.sum((y - y.mean()) ** 2))
    if whole == 0 or len(y) <= there.sum():
        return 0.0
    ratio = float(np.sum(sums[there] ** 2 / counts[there])) / whole
    return 1 - (1 - ratio) * (len(y) - 1) / float(len(y) - there.sum())  # eq. (1)


def _swapped(f: Floats) -> tuple[Floats, Floats]:
    """Return S and T of (2)."""
    f = f - f[:2].mean()
    a, b, ab = f[0], f[1], f[2:]
    variance = float(f[:2].var()) or 1.0
    return (b * (ab - a)).mean(axis=1) / variance, ((a - ab) ** 2).mean(axis=1) / (2 * variance)  # eq. (2)


def _interval(spread: Floats, value: Floats) -> Floats:
    """Return the ends of 90 % intervals about a value, from the deviation of resamples, shape (d, k)."""
    half = 1.645 * spread.std(axis=1)
    return np.stack([value - half, value + half], axis=1)
