"""Outliers: samples so far off that they would bias an alignment.

A row is an outlier if, in any channel, its residual differs from the median of its seven neighbours, and from
the nearest of the parabolas (1) through them, by more than `NOISE` times the stated noise, `SPREAD` times the
usual such difference (1.48 MAD of the first) and `NEARBY` times that of most rows around it. A gap of the
model is smoother than that, however large, and rings for several rows. These rows are left out of the
alignment and, of `SMOOTH` quantities, of the gap; torques, accelerations and strains jump where teeth strike,
and the gap counts it.

A model with an effect `outliers` at a signal knows their share and size. Rows that its law takes for
outliers, by the same difference from the median, are removed from alignment and gap. A drive moves from
sample to sample; its samples y are told apart by their difference from the median of three predictions, each
exact for a parabola:

    3 y_{i-1} - 3 y_{i-2} + y_{i-3},   the same from the other side,
    (-y_{i-2} + 4 y_{i-1} + 4 y_{i+1} - y_{i+2})/6                                                   (1)

An outlier among its neighbours may cost a good sample its place, which a drive can spare.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats

if TYPE_CHECKING:
    from flexarm.effects.outliers import Outliers

NEIGHBOURS = 7
NOISE, SPREAD, NEARBY = 100.0, 20.0, 6.0
AROUND, MOST_OF_THEM = 6, 0.8
"""Rows on either side that are around one, and the share of them that is most."""
SMOOTH = ("position", "deflection", "joint_angle", "inclination", "orientation")
"""Quantities of which no machine jumps from one row to the next and back."""


def outliers(residual: Floats, noise: Floats | float) -> NDArray[np.bool_]:
    """Return the rows of a residual that are outliers, bool of shape (n,).

    The residual, (n, channels), is NaN where there is no value; the noise is 1 sigma of all channels or each.
    """
    found = np.zeros(len(residual), dtype=bool)
    rows, off, usual = deviation_from_median(residual)
    limit = np.maximum(NOISE * noise, SPREAD * usual)
    if not np.any(np.abs(off) > limit):  # what most signals are spared
        return found
    size = np.minimum(np.abs(off), deviation_from_parabolas(residual[rows]))
    far = np.flatnonzero(np.any(size > limit, axis=1))
    found[rows[far]] = np.any(size[far] > np.maximum(limit, NEARBY * nearby(size, far)), axis=1)
    return found


def beyond_range_of_others(residual: Floats, rows: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the rows further from the median of the others than twice the range of these."""
    if rows.all():
        return np.zeros_like(rows)
    ranges = 2.0  # ranges of the other rows beyond which one is an outlier where a quantity jumps by itself
    middle = np.nanmedian(residual, axis=0)
    usual = np.nanmax(np.abs(residual[~rows] - middle), axis=0)
    return np.asarray(np.any(np.abs(residual - middle) > 2 * ranges * usual, axis=1))


def nearby(size: Floats, rows: NDArray[np.intp]) -> Floats:
    """Return the size that most rows around each of `rows` do not exceed, shape (rows, channels).

    `size` (n, channels) has more than `AROUND` rows.
    """
    edge = np.pad(size, ((AROUND, AROUND), (0, 0)), mode="reflect")
    windows = np.lib.stride_tricks.sliding_window_view(edge, 2 * AROUND + 1, axis=0)[rows]
    return np.asarray(np.quantile(np.delete(windows, AROUND, axis=-1), MOST_OF_THEM, axis=-1))


def row_list(rows: Sequence[int | str], what: str = "row") -> str:
    """Return numbers of rows, or names of poses, as text.

    >>> row_list([4]), row_list([1, 2, 3, 4, 5, 6])
    ('row 4', 'rows 1, 2, 3, 4, 5, ...')
    """
    shown = 5  # rows that are told one by one
    numbers = ", ".join(map(str, rows[:shown])) + ", ..." * (len(rows) > shown)
    return f"{what}{'s' * (len(rows) > 1)} {numbers}"


def expected_outliers(residual: Floats, noise: Floats, effect: Outliers) -> NDArray[np.bool_]:
    """Return the rows of a residual that an effect takes for outliers, given the noise or the usual scatter.

    Parameters and result as for `outliers`.
    """
    found = np.zeros(len(residual), dtype=bool)
    rows, off, usual = deviation_from_median(residual)
    found[rows] = effect.told_apart(off, np.maximum(noise, usual))
    return found


def drive_outliers(samples: Floats, noise: float, effect: Outliers) -> NDArray[np.bool_]:
    """Return the samples of a drive, shape (n,), that an effect takes for outliers; drop-outs are none."""
    found = np.zeros(len(samples), dtype=bool)
    rows = np.flatnonzero(np.isfinite(samples))
    if len(rows) <= NEIGHBOURS:
        return found
    off = samples[rows] - np.nanmedian(parabolas(samples[rows]), axis=0)  # eq. (1)
    usual = 1.48 * np.median(np.abs(off))
    found[rows] = effect.told_apart(off[:, None], np.array([max(noise, float(usual))]))
    return found


def parabolas(samples: Floats) -> Floats:
    """Return the predictions (1) of every sample, shape (3, n): from before, after and both sides."""
    n = len(samples)
    y = np.full(n + 6, np.nan)
    y[3:-3] = samples
    before = 3 * y[2 : n + 2] - 3 * y[1 : n + 1] + y[:n]
    after = 3 * y[4 : n + 4] - 3 * y[5 : n + 5] + y[6:]
    between = (-y[1 : n + 1] + 4 * y[2 : n + 2] + 4 * y[4 : n + 4] - y[5 : n + 5]) / 6
    return np.stack([before, after, between])


def deviation_from_parabolas(values: Floats) -> Floats:
    """Return the distance to the nearest of the three parabolas (1), shape (n, channels)."""
    off = np.stack([np.abs(y - parabolas(y)) for y in values.T], axis=-1)
    known = np.where(np.isfinite(off), off, np.inf).min(axis=0)
    return np.where(np.isfinite(known), known, 0.0)


def deviation_from_median(residual: Floats) -> tuple[NDArray[np.intp], Floats, Floats]:
    """Return rows with a value in every channel, their differences from the median, and the usual size.

    No rows where there are too few for a median.
    """
    rows = np.flatnonzero(np.isfinite(residual).all(axis=1))
    rows = rows if len(rows) > NEIGHBOURS else rows[:0]
    if not len(rows):
        return rows, residual[rows], np.zeros(residual.shape[1])
    from scipy.ndimage import median_filter

    values = residual[rows]
    off = values - median_filter(values, size=(NEIGHBOURS, 1), mode="mirror")  # no end beside itself
    return rows, off, 1.48 * np.median(np.abs(off), axis=0)
