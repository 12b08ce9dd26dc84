"""Cubic spline through noisy samples, by least squares on given breaks, in time linear in the samples.

A cubic spline with m intervals is s(t) = sum_j c_j B_j(t), with m + 3 B-splines B_j, four of them non-zero in
an interval. The coefficients minimise the squared misfit,

    sum_i (y_i - s(t_i))^2 -> min,        B^T B c = B^T y                                            (1)

with B^T B of half band width 3, so that Cholesky's factorisation costs 16 operations a coefficient. A spline
that starts at rest, s'(t_0) = 0, has c_0 = c_1: the first two columns of B are added up.

Units: those of the samples. Source: [deBoor2001], chapters IX and XIV.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

DEGREE = 3


def fit_spline(
    time: NDArray[np.float64], values: NDArray[np.float64], breaks: NDArray[np.intp], at_rest: bool = False
) -> tuple[BSpline, NDArray[np.float64]]:
    """Least-squares cubic spline (1) whose breaks are samples.

    Parameters
    ----------
    time, values : ndarray, shape (n,)
        Rising times and the samples.
    breaks : ndarray of int, shape (m + 1,)
        Rising indices of the samples that are breaks; the first is 0 and the last n - 1, and most of them at
        least two apart: there must be no more coefficients than samples.
    at_rest : bool
        Whether the slope at the first break is zero.

    Returns
    -------
    spline : BSpline
        The spline.
    fitted : ndarray, shape (n,)
        Its values at the samples.
    """
    from scipy.interpolate import BSpline
    from scipy.linalg import solveh_banded

    at = time[breaks]
    knots = np.concatenate([np.repeat(at[0], DEGREE), at, np.repeat(at[-1], DEGREE)])
    design = BSpline.design_matrix(time, knots, DEGREE)
    rows = design.data.reshape(-1, DEGREE + 1).T.copy()  # the four that are not zero at a sample
    first = design.indices[:: DEGREE + 1]
    if at_rest:
        start = first == 0
        rows[1, start] += rows[0, start]
        rows[0, start] = 0.0
    band, right = _normal_equations(rows, np.searchsorted(first, np.arange(len(at) - 1)), values)
    if at_rest:
        band[0, 0] = 1.0
    coefficients = solveh_banded(band, right, lower=True, check_finite=False)  # eq. (1)
    if at_rest:
        coefficients[0] = coefficients[1]
    return BSpline(knots, coefficients, DEGREE), design @ coefficients


def _normal_equations(
    rows: NDArray[np.float64], interval_start: NDArray[np.intp], values: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """B^T B as a lower band and B^T y of eq. (1), summed interval by interval."""
    intervals = len(interval_start)
    band = np.zeros((DEGREE + 1, intervals + DEGREE))
    right = np.zeros(intervals + DEGREE)
    for i in range(DEGREE + 1):
        right[i : i + intervals] += np.add.reduceat(rows[i] * values, interval_start)
        for j in range(i, DEGREE + 1):
            band[j - i, i : i + intervals] += np.add.reduceat(rows[i] * rows[j], interval_start)
    return band, right
