"""Cubic spline through noisy samples, by least squares on given breaks, in time linear in the samples.

A cubic spline with m intervals is s(t) = sum_j c_j B_j(t), with m + 3 B-splines B_j, four of them non-zero in
an interval. The coefficients minimise the squared misfit,

    sum_i (y_i - s(t_i))^2 -> min,        B^T B c = B^T y                                            (1)

with B^T B of half band width 3, so that Cholesky's factorisation costs 16 operations a coefficient. A spline
that starts at rest, s'(t_0) = 0, has c_0 = c_1. One that is constant in an interval has its four coefficients
equal there, since the B-splines add up to one. It is monotone where its coefficients are. With c = E d, E of
zeros and ones, and fewer elements of d,

    E^T B^T B E d = E^T B^T y                                                                        (2)

Jumps J c of the third derivative at inner breaks may have a penalty of weights w. Five B-splines meet there,
so that the half band width is 4:

    (B^T B + J^T diag(w) J) c = B^T y                                                                (3)

Units: those of the samples. Source: [deBoor2001], chapters IX and XIV.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexarm import _core
from flexarm.arrays import Floats

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

Indices = NDArray[np.intp]

DEGREE = 3


def fit_spline(
    time: Floats,
    values: Floats,
    breaks: Indices,
    at_rest: bool = False,
    equal: Collection[int] = (),
    penalty: Floats | None = None,
) -> tuple[BSpline, Floats]:
    """Return the least-squares cubic spline (1) whose breaks are samples, and its values at all samples (n,).

    `time` rises, of shape (n,) as `values`. `breaks` (m + 1,) are rising indices of samples from 0 to n - 1,
    most of them at least two apart: there must be no more coefficients than samples. With `at_rest` the slope
    at the first break is zero. `equal` are coefficients, of 1 to m + 2, that are equal to the one before.
    `penalty`
    (m - 1,) are the weights w of (3) at the inner breaks.
    """
    from scipy.interpolate import BSpline
    from scipy.linalg import solveh_banded

    at = time[breaks]
    knots = np.concatenate([np.repeat(at[0], DEGREE), at, np.repeat(at[-1], DEGREE)])
    band, right = _core.spline_equations(time, values, breaks)
    if penalty is not None:
        band = _penalised(band, knots, penalty)  # eq. (3)
    unknown = _unknown(len(right), at_rest, equal)
    if unknown[-1] + 1 < len(right):
        band, right = _reduced(band, right, unknown)
    coefficients = solveh_banded(band, right, lower=True, check_finite=False)[unknown]  # eq. (2)
    return BSpline(knots, coefficients, DEGREE), _core.spline_values(time, breaks, coefficients)


def constant_in(intervals: Iterable[int]) -> frozenset[int]:
    """Return the coefficients equal to the one before in a spline that is constant in some intervals."""
    return frozenset(interval + k for interval in intervals for k in range(1, DEGREE + 1))


def _unknown(count: int, at_rest: bool, equal: Collection[int]) -> Indices:
    """Return the index of d of (2) for every coefficient."""
    rises = np.ones(count, dtype=np.intp)
    rises[0] = 0
    if at_rest:
        rises[1] = 0
    rises[list(equal)] = 0
    return np.cumsum(rises)


def _reduced(band: Floats, right: Floats, unknown: Indices) -> tuple[Floats, Floats]:
    """Return both sides of (2); equal coefficients are adjacent, so that the band grows no wider."""
    count = int(unknown[-1]) + 1
    fewer, less = np.zeros((len(band), count)), np.zeros(count)
    np.add.at(less, unknown, right)
    for below in range(len(band)):
        column = np.arange(len(right) - below)
        row, lower = unknown[column + below], band[below, : len(column)]
        np.add.at(fewer, (row - unknown[column], unknown[column]), lower)
        if below:  # an element above the diagonal falls onto it
            onto = row == unknown[column]
            np.add.at(fewer[0], unknown[column][onto], lower[onto])
    return fewer, less


def _penalised(band: Floats, knots: Floats, penalty: Floats) -> Floats:
    """Return the left side of (3) as a lower band, one wider than that of (1)."""
    jumps = _jumps(knots)
    found = np.vstack([band, np.zeros(band.shape[1])])
    for i in range(DEGREE + 2):
        for j in range(i, DEGREE + 2):
            found[j - i, i : i + len(penalty)] += penalty * jumps[i] * jumps[j]
    return found


def _jumps(knots: Floats) -> Floats:
    """Return the jump of the third derivative at every inner break by five coefficients, shape (5, m - 1)."""
    slopes = np.ones((1, len(knots) - DEGREE - 1))  # of derivative 0: its own coefficient
    for order in range(1, DEGREE + 1):
        width = knots[DEGREE + 1 : len(knots) - order] - knots[order : len(knots) - DEGREE - 1]
        rise = np.zeros((order + 1, slopes.shape[1] - 1))
        rise[1:] += slopes[:, 1:]
        rise[:-1] -= slopes[:, :-1]
        slopes = (DEGREE + 1 - order) * rise / width
    found = np.zeros((DEGREE + 2, slopes.shape[1] - 1))
    found[1:] += slopes[:, 1:]
    found[:-1] -= slopes[:, :-1]
    return found
