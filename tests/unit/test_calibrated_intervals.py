"""Intervals of parameters in whose logarithm a model is curved, against closed forms."""

import numpy as np
import pytest
from pytest import approx

from flexarm.calibration.intervals import bend_of, bent_marginal, transformed
from flexarm.named_effects import NORMAL_90


@pytest.mark.parametrize("bend", [-1.0, -0.4, 0.0, 0.7, 1.0])
def test_the_bend_of_a_response_is_found(bend):
    assert bend_of(0.8, float(transformed(0.8, bend))) == approx(bend, abs=1e-6)


def test_a_response_beyond_all_bends_has_the_nearest_one():
    assert bend_of(0.5, 0.1) == 1.0
    assert bend_of(0.5, 2.0) == -1.0


def test_without_a_bend_the_interval_is_that_of_a_normal_distribution():
    """Data N(0.2, 0.3^2) and prior N(-1, 2^2) about u = 1."""
    found = bent_marginal(1.0, 0.0, (0.2, 0.3), (-1.0, 2.0))
    weight = np.array([1 / 0.3**2, 1 / 2.0**2])
    mean, sigma = float(weight @ [1.2, -1.0]) / weight.sum(), weight.sum() ** -0.5
    assert (found.quantile(0.05), found.quantile(0.95)) == approx(
        (mean - NORMAL_90 * sigma, mean + NORMAL_90 * sigma), abs=1e-3
    )


def test_compliances_that_data_know_have_intervals_of_a_normal_compliance():
    """lambda = 1 and a wide prior: x = 1 - exp(-d) is N(0, 0.2^2), but for the volume of u, 1/(1 - x)."""
    found = bent_marginal(0.0, 1.0, (0.0, 0.2), (0.0, 50.0))
    x = np.linspace(-2, 1 - 1e-3, 400001)
    density = np.exp(-((x / 0.2) ** 2) / 2) / (1 - x)
    share = np.cumsum(density) / density.sum()
    expected = -np.log(1 - np.interp([0.05, 0.95], share, x))
    assert (found.quantile(0.05), found.quantile(0.95)) == approx(tuple(expected), abs=0.01)
    assert found.one_sided == ""


@pytest.mark.parametrize(("bend", "side"), [(1.0, "low"), (-1.0, "high"), (0.0, "")])
def test_data_that_allow_nothing_set_one_end(bend, side):
    """The estimate is as large as its sigma: 1.645 of them reach beyond none."""
    found = bent_marginal(0.0, bend, (0.0, 1.0), (0.0, 3.0))
    assert found.one_sided == side
    assert found.quantile(0.05) < 0 < found.quantile(0.95)
    assert (found.quantile(0.95) > -1.5 * found.quantile(0.05)) == (bend > 0)
    assert (found.quantile(0.05) < -1.5 * found.quantile(0.95)) == (bend < 0)
