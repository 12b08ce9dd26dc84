"""Sobol indices: the part of a result's variance that each parameter explains.

From any n independent samples of y, regressed on one parameter by p functions, linear between knots at
quantiles (of a parameter with few values: one constant each),

    R^2 = 1 - sum (y - fit)^2 / sum (y - mean)^2,  S = 1 - (1 - R^2) (n - 1)/(n - 1 - p)                  (1)

is the first-order index less what chance gives it (adjusted R^2); values below zero are chance. From
Saltelli's rows A, B and AB_i

    S_i = mean(f_B (f_AB_i - f_A)) / V,  T_i = mean((f_A - f_AB_i)^2) / (2 V)                             (2)

with f centred and V its variance over A and B: first-order and total index. For a series both sums of (1) run
over its instants and channels too, which is the generalised index of a vector. Sources: C. Storlie and
J. Helton, "Multiple predictor smoothing methods for sensitivity analysis", Reliability Engineering and System
Safety 93 (2008), 28-54; A. Saltelli et al., Computer Physics Communications 181 (2010), 259-270, table 2 (b)
and (f); F. Gamboa et al., "Sensitivity analysis for multidimensional and functional outputs", Electronic
Journal of Statistics 8 (2014), 575-603.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexarm.arrays import Floats

LEAST = 40
"""Samples below which (1) says nothing."""
RESAMPLES, MOST_RESAMPLED = 200, 4096
"""Of the bootstrap of intervals, which shrink as 1/sqrt(n), and samples in each at most."""


@dataclass(frozen=True)
class Indices:
    """Indices of one result, an entry for each parameter: first order and total, with ends of 90 % intervals.

    Shapes are (d,) and (d, 2); the total is NaN where the samples do not tell it.
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
    rng = np.random.default_rng(seed)
    m = min(n, MOST_RESAMPLED)
    draws = [rng.integers(n, size=m) for _ in range(RESAMPLES)]
    bases = [_basis(column) for column in x.T]
    first = np.array([_adjusted(basis, y) for basis in bases])
    spread = np.array([[_adjusted(basis[draw], y[draw]) for draw in draws] for basis in bases])
    unknown = np.full(d, np.nan)
    return Indices(first, _interval(spread, first, np.sqrt(m / n)), unknown, np.full((d, 2), np.nan))


class SeriesIndices:
    """First-order indices (1) of a series, gathered piece by piece, of samples x of parameters, (n, d)."""

    def __init__(self, x: Floats) -> None:
        self._bases = [_basis(column) for column in x.T]
        self._count = len(x)
        self._whole = 0.0
        self._explained = np.zeros(x.shape[1])

    def add(self, y: Floats) -> None:
        """Take up values, shape (n, columns), of some instants and channels."""
        off = y - y.mean(axis=0)
        self._whole += float(np.sum(off**2))
        self._explained += [float(np.sum((basis.T @ off) ** 2)) for basis in self._bases]

    @property
    def variance(self) -> float:
        """Sum of the variances of all columns."""
        return self._whole / self._count

    @property
    def chance(self) -> float:
        """Twice the standard deviation of an index of a parameter without influence, sqrt(2 p)/n."""
        return 2 * float(np.sqrt(2 * max(basis.shape[1] for basis in self._bases))) / self._count

    @property
    def first(self) -> Floats:
        """The indices."""
        if self._whole == 0:
            return np.zeros(len(self._bases))
        ratios = self._explained / self._whole
        sizes = [basis.shape[1] for basis in self._bases]
        return np.array([_less_chance(r, self._count, p) for r, p in zip(ratios, sizes, strict=True)])


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


def _basis(x: Floats) -> Floats:
    """Return orthonormal functions of a parameter without their means, shape (n, p)."""
    most_knots = 12
    few = 32  # different values of a parameter that are each a constant
    values, which = np.unique(x, return_inverse=True)
    if len(values) < min(few, len(x) // 2):
        columns = np.eye(len(values))[which][:, 1:]
    else:
        count = int(np.clip(np.sqrt(len(x)) / 3, 2, most_knots))
        knots = np.quantile(x, np.arange(1, count) / count)
        columns = np.column_stack([x, *(np.maximum(x - knot, 0.0) for knot in knots)])
    columns = columns - columns.mean(axis=0)
    scale = np.abs(columns).max(axis=0)
    return np.asarray(np.linalg.qr(columns[:, scale > 0] / scale[scale > 0])[0])


def _adjusted(basis: Floats, y: Floats) -> float:
    """Return S of (1)."""
    off, columns = y - y.mean(), basis - basis.mean(axis=0)
    whole, along = float(off @ off), columns.T @ off
    if whole == 0:
        return 0.0
    fit, _, p, _ = np.linalg.lstsq(columns.T @ columns, along)  # a resample may lack a value
    return _less_chance(float(along @ fit) / whole, len(y), int(p))


def _less_chance(ratio: float, n: int, p: int) -> float:
    """Return S of (1), given R^2."""
    return 1 - (1 - ratio) * (n - 1) / max(n - 1 - p, 1)  # eq. (1)


def _swapped(f: Floats) -> tuple[Floats, Floats]:
    """Return S and T of (2)."""
    f = f - f[:2].mean()
    a, b, ab = f[0], f[1], f[2:]
    variance = float(f[:2].var()) or 1.0
    return (b * (ab - a)).mean(axis=1) / variance, ((a - ab) ** 2).mean(axis=1) / (2 * variance)  # eq. (2)


def _interval(spread: Floats, value: Floats, factor: float = 1.0) -> Floats:
    """Return the ends of 90 % intervals, from `factor` times the deviation of resamples, shape (d, k)."""
    half = 1.645 * factor * spread.std(axis=1)
    return np.stack([value - half, value + half], axis=1)
