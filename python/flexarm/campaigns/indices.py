"""Sobol indices: the part of a result's variance that each parameter explains.

From any n samples of y, regressed at once on functions of all parameters, p of each, linear between knots at
quantiles (of a parameter with few values: one constant each), y = mean + sum_i X_i b_i + e with e of variance
s^2, C the inverse of X^T X and C_ii its block of parameter i,

    S_i = (|X_i b_i|^2 - s^2 tr(X_i^T X_i C_ii)) / |y - mean|^2                                           (1)

is the first-order index less what chance gives it; values below zero are chance. Parameters fitted together
are no noise of one another. With fewer than three samples a function each is fitted alone, and S_i
is the adjusted R^2. On a full grid chance explains nothing. From Saltelli's rows A, B and AB_i

    S_i = mean(f_B (f_AB_i - f_A)) / V,  T_i = mean((f_A - f_AB_i)^2) / (2 V)                             (2)

with f centred and V its variance over A and B: first-order and total index. For a series the sums of (1) run
over its instants and channels too, which is the generalised index of a vector. Sources: C. Storlie and
J. Helton, "Multiple predictor smoothing methods for sensitivity analysis", Reliability Engineering and System
Safety 93 (2008), 28-54; A. Saltelli et al., Computer Physics Communications 181 (2010), 259-270, table 2 (b)
and (f); F. Gamboa et al., "Sensitivity analysis for multidimensional and functional outputs", Electronic
Journal of Statistics 8 (2014), 575-603.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import prod
from typing import NamedTuple

import numpy as np

from flexarm.arrays import Floats

LEAST = 40
"""Samples below which (1) says nothing."""
RESAMPLES, MOST_RESAMPLED = 200, 1024
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
    off, design = y[:, None] - y.mean(), _Design.of(x, bases)
    first = _Regression(bases, design).indices(off)
    resamples = ((off[draw] - off[draw].mean(), [basis[draw] for basis in bases]) for draw in draws)
    spread = np.array([_Regression(drawn, design).indices(values) for values, drawn in resamples]).T
    unknown = np.full(d, np.nan)
    return Indices(first, _interval(spread, first, np.sqrt(m / n)), unknown, np.full((d, 2), np.nan))


class _Design(NamedTuple):
    """How samples lie."""

    together: bool
    """True if there are enough of them to fit all parameters at once."""
    grid: bool
    """True for a full grid, whose parameters are no noise of one another: chance explains nothing."""

    @classmethod
    def of(cls, x: Floats, bases: Sequence[Floats]) -> _Design:
        """Return the design of samples, shape (n, d)."""
        levels = [len(np.unique(column)) for column in x.T]
        grid = prod(levels) == len(x) > max(levels)
        return cls(not grid and 3 * sum(basis.shape[1] for basis in bases) <= len(x), grid)


class _Regression:
    """Regression on functions of the parameters, shapes (n, p), and what it explains of given values."""

    def __init__(self, bases: Sequence[Floats], design: _Design) -> None:
        self._count, self._design = len(bases[0]), design
        self._sizes = [basis.shape[1] for basis in bases]
        self._groups = self._fitted_together([basis - basis.mean(axis=0) for basis in bases])
        self.whole = 0.0
        self._explained = np.zeros(len(bases))
        self._residual = np.zeros(len(bases))

    def _fitted_together(self, bases: list[Floats]) -> list[tuple[Floats, Floats, list[int]]]:
        """Return functions, C of (1) and the parameters of each fit."""
        groups = [list(range(len(bases)))] if self._design.together else [[i] for i in range(len(bases))]
        columns = [np.hstack([bases[i] for i in group]) for group in groups]
        inverses = [np.asarray(np.linalg.pinv(X.T @ X), dtype=float) for X in columns]
        return list(zip(columns, inverses, groups, strict=True))

    def add(self, off: Floats) -> None:
        """Take up values without their means, shape (n, columns)."""
        whole = float(np.sum(off**2))
        self.whole += whole
        for X, C, group in self._groups:
            along = X.T @ off
            b = C @ along
            self._residual[group] += whole - float(np.sum(b * along))
            for i, own in self._blocks(group):
                self._explained[i] += float(np.sum((X[:, own] @ b[own]) ** 2))

    def indices(self, off: Floats | None = None) -> Floats:
        """Return S of (1) of all that was given, and of `off`."""
        if off is not None:
            self.add(off)
        if self.whole == 0:
            return np.zeros(len(self._sizes))
        chance = np.zeros(len(self._sizes))
        for X, C, group in [] if self._design.grid else self._groups:
            free = max(self._count - 1 - X.shape[1], 1)
            for i, own in self._blocks(group):
                chance[i] = np.sum((X[:, own].T @ X[:, own]) * C[own, own].T) * self._residual[i] / free
        return np.asarray((self._explained - chance) / self.whole)  # eq. (1)

    @property
    def unexplained(self) -> float:
        """The greatest part of the variance that a fit leaves."""
        return float(self._residual.max()) / self.whole if self.whole else 1.0

    def _blocks(self, group: list[int]) -> Iterator[tuple[int, slice]]:
        """Yield parameters of a fit with their columns."""
        ends = np.cumsum([self._sizes[i] for i in group])
        for i, end in zip(group, ends, strict=True):
            yield i, slice(int(end) - self._sizes[i], int(end))


class SeriesIndices:
    """First-order indices (1) of a series, gathered piece by piece, of samples x of parameters, (n, d)."""

    def __init__(self, x: Floats) -> None:
        bases = [_basis(column) for column in x.T]
        self._regression = _Regression(bases, _Design.of(x, bases))
        self._count, self._functions = len(x), max(basis.shape[1] for basis in bases)

    def add(self, y: Floats) -> None:
        """Take up values, shape (n, columns), of some instants and channels."""
        self._regression.add(y - y.mean(axis=0))

    @property
    def variance(self) -> float:
        """Sum of the variances of all columns."""
        return self._regression.whole / self._count

    @property
    def chance(self) -> float:
        """Twice the deviation of an index without influence: sqrt(2 p)/n of what fits leave."""
        return 2 * float(np.sqrt(2 * self._functions)) / self._count * self._regression.unexplained

    @property
    def first(self) -> Floats:
        """The indices."""
        return self._regression.indices()


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
