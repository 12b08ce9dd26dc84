"""Claims about what a gap follows: a curve explains what depends on its state, and no more."""

import numpy as np
import pytest

from flexarm.residual_analysis.motion_states import (
    correlation_ratio,
    covariate_dependence,
    intervals,
)

RNG = np.random.default_rng(6)


def test_a_curve_over_a_state_explains_what_depends_on_it():
    state = np.linspace(-1, 1, 2000)
    assert correlation_ratio(intervals(state), np.sign(state)[:, None]) > 0.95
    alternating = np.where(np.arange(2000) % 2, 1.0, -1.0)
    assert correlation_ratio(intervals(state), alternating[:, None]) < 0.01


def test_the_sign_explains_three_quarters_of_a_line():
    """(integral of |x|)^2 over the integral of x^2, on (-1, 1): 3/4."""
    x = np.linspace(-1, 1, 4001)
    assert correlation_ratio((x > 0).astype(int), x[:, None]) == pytest.approx(0.75, abs=1e-3)


def test_noise_follows_nothing():
    """Less what the means get from noise, the share is zero within 4 sigma of 2/n sum of 25 chi-squares."""
    x, noise = RNG.uniform(-1, 1, 1000), RNG.standard_normal((1000, 1))
    found = covariate_dependence({"x": (2, intervals(x, 25))}, noise)
    assert found.adjusted["x"] < 4 * np.sqrt(2 * 25) / 1000
    assert found.best == "a constant"


def test_shares_beyond_a_constant_are_of_what_it_leaves():
    """3 + x on (-1, 1): 9 of 9 1/3 is constant, all of the rest follows x."""
    x = np.linspace(-1, 1, 4001)
    found = covariate_dependence({"x": (2, intervals(x, 100))}, 3 + x[:, None])
    assert found.constant == pytest.approx(9 / (9 + 1 / 3), abs=1e-3)
    assert found.adjusted["x"] == pytest.approx(1.0, abs=1e-3)
    assert found.best == "a constant"  # the rest is 3.6 % of the whole


def test_of_two_that_explain_alike_the_simpler_is_named():
    x = RNG.uniform(-1, 1, 1000)
    covariate_groups = {"a curve": (2, intervals(x, 20)), "its sign": (1, (x > 0).astype(int))}
    assert covariate_dependence(covariate_groups, np.sign(x)[:, None]).best == "its sign"
    assert covariate_dependence(covariate_groups, x[:, None]).best == "a curve"
