"""Outliers among their neighbours: only rows far off are looked at, with the same answer as for all rows."""

import numpy as np
import pytest

from flexarm.measurement.outliers import AROUND, MOST_OF_THEM, nearby, outliers


@pytest.fixture
def residual():
    rng = np.random.default_rng(5)
    quiet = 1e-4 * rng.standard_normal((400, 2))
    quiet[[0, 57, 399], [0, 1, 0]] += 0.5
    return quiet


def test_the_size_nearby_is_the_quantile_of_the_rows_on_both_sides(residual):
    size = np.abs(residual)
    rows = np.array([AROUND, 57, 300])
    for row, found in zip(rows, nearby(size, rows), strict=True):
        around = [k for k in range(row - AROUND, row + AROUND + 1) if k != row]
        assert found == pytest.approx(np.quantile(size[around], MOST_OF_THEM, axis=0))


def test_single_rows_far_off_are_outliers_and_no_others(residual):
    assert list(np.flatnonzero(outliers(residual, np.array([1e-4, 1e-4])))) == [0, 57, 399]


def test_a_ringing_gap_is_no_outlier():
    """Each row is far from its median, and so are those around it."""
    ringing = np.where(np.arange(200) % 2, 0.5, -0.5)[:, None] * np.ones((1, 1))
    assert not outliers(ringing, np.array([1e-4])).any()
