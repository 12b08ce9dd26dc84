"""Intervals along a curved valley, against integrals in closed form."""

from dataclasses import dataclass, field, replace
from math import log

import numpy as np
import pytest
from pytest import approx

from flexarm.arrays import Floats
from flexarm.calibration.discrepancy import Channel, Process
from flexarm.calibration.estimation import Estimation, Point, Posterior, Weighting
from flexarm.calibration.intervals import marginals
from flexarm.calibration.optimum import posterior_of
from flexarm.calibration.parameters import FreeParameter
from flexarm.calibration.policy import CalibrationPolicy
from flexarm.calibration.valley import valley_of

SIGMA = 0.05
"""1 sigma of the datum u_1 - curvature u_0^2."""


@dataclass(frozen=True)
class White:
    """White noise and no other error."""

    input_errors: Floats = field(default_factory=lambda: np.empty((0, 1)))
    processes: tuple[Process, ...] = ()

    def root(self, values: Floats) -> Floats:
        return values

    def times(self, values: Floats) -> Floats:
        return values

    def covariance(self, jacobian: Floats, prior: Floats, inverse: Floats) -> Floats:
        return inverse


@dataclass(eq=False)
class Banana(Estimation):
    """One datum, u_1 - curvature u_0^2 = 0; u_0 is known by its prior N(0, 1) alone."""

    curvature: float = 0.0

    def linearised(self, u: Floats) -> Point:
        jacobian = np.array([[-2 * self.curvature * u[0], 1.0]]) / SIGMA
        return Point(u, self.residual(u, jacobian), jacobian, np.empty((0, 1)))

    def residual(self, u: Floats, jacobian: Floats) -> Floats:
        return np.array([u[1] - self.curvature * u[0] ** 2]) / SIGMA


def posterior(curvature: float, last_move: float = 0.0) -> Posterior:
    """The normal posterior about the most probable values, zeros."""
    free = tuple(
        FreeParameter(f"u{k}", "m", "nominal", "linear", 0.0, sigma) for k, sigma in enumerate((1, 50))
    )
    estimation = Banana(None, None, free, (), CalibrationPolicy(), curvature=curvature)  # type: ignore[arg-type]
    point = estimation.linearised(np.zeros(2))
    H = point.jacobian.T @ point.jacobian + estimation.precision()
    inverse = np.linalg.inv(H)
    found = Posterior(estimation, point, White(), inverse, inverse, np.full(2, last_move), 1)  # type: ignore[arg-type]
    return replace(found, valley=valley_of(found))


@pytest.mark.parametrize("k", [0, 1])
def test_a_bent_posterior_has_the_intervals_of_its_integral(k):
    """u_0 is N(0, 1) and u_1 given it N(u_0^2, 0.05^2): u_1 is chi-squared with one degree, but for noise."""
    rng = np.random.default_rng(1)
    u_0 = rng.standard_normal(400_000)
    exact = (u_0, u_0**2 + SIGMA * rng.standard_normal(len(u_0)))[k]
    found = marginals(posterior(1.0))[k]
    assert found.quantile(0.05) == approx(np.quantile(exact, 0.05), abs=0.05)
    assert found.quantile(0.95) == approx(np.quantile(exact, 0.95), abs=0.12)


def test_a_straight_posterior_stays_normal():
    straight = posterior(0.0)
    assert straight.valley is None
    [first, _] = marginals(straight)
    assert first.quantile(0.95) == approx(1.645, abs=2e-3)


def test_no_valley_is_followed_from_estimates_that_are_not_at_rest():
    """Their intervals are normal about them: a profile from there has its minimum elsewhere."""
    moving = posterior(1.0, last_move=3.0)
    assert moving.valley is None
    for found in marginals(moving):
        assert found.quantile(0.05) < 0.0 < found.quantile(0.95)


@dataclass(eq=False)
class FalseOptimum(Estimation):
    """F = u^2 + 9 exp(-2 (u/1.5)^4), prior N(0, 1) included: least near 1.8, and flat on a hill at 0."""

    def linearised(self, u: Floats) -> Point:
        slope = -4 / 1.5 * (u[0] / 1.5) ** 3
        jacobian = slope * self.residual(u, np.empty((1, 1)))[:, None]
        return Point(u, self.residual(u, jacobian), jacobian, np.empty((0, 1)))

    def residual(self, u: Floats, jacobian: Floats) -> Floats:
        return 3 * np.exp(-((u / 1.5) ** 4))

    def weighting(self, residual: Floats, input_errors: Floats, spread: Floats) -> Weighting:
        return White()  # type: ignore[return-value]


def test_an_estimate_goes_on_from_a_lower_point_of_its_valley():
    free = (FreeParameter("u", "m", "nominal", "linear", 0.0, 1.0),)
    told: list[str] = []
    estimation = FalseOptimum(range(1), None, free, (), CalibrationPolicy())  # type: ignore[arg-type]
    found = posterior_of(estimation, told.append)
    assert "the valley has a lower point" in told
    assert abs(found.point.u[0]) == approx(1.8, abs=0.2)
    assert found.objective(found.point.u) < 4.0


TIME = np.linspace(0, 8, 400)
TRUE, PRIOR = log(2 * np.pi * 0.9), 0.4


@dataclass(eq=False)
class Swing(Estimation):
    """A wave of 200 times the noise, whose frequency is known to a factor of 1.5: five periods in or out."""

    def residual(self, u: Floats, jacobian: Floats) -> Floats:
        noise = np.random.default_rng(1).standard_normal(len(TIME))
        return 200 * (np.sin(np.exp(TRUE) * TIME) - np.sin(np.exp(u[0]) * TIME)) + noise

    def linearised(self, u: Floats) -> Point:
        jacobian = -200 * (np.exp(u[0]) * TIME * np.cos(np.exp(u[0]) * TIME))[:, None]
        return Point(u, self.residual(u, jacobian), jacobian, np.empty((0, len(TIME))))

    def weighting(self, residual: Floats, input_errors: Floats, spread: Floats) -> Weighting:
        n = len(TIME)
        channel = Channel.of_motion(n, 1.0, input_errors)
        return Weighting.of([slice(0, n)], [channel], residual, input_errors, spread)


def test_other_starts_find_a_frequency_whose_waves_were_out_of_step():
    free = (FreeParameter("u", "rad/s", "nominal", "log", log(2 * np.pi * 0.55), PRIOR),)
    told: list[str] = []
    estimation = Swing(range(len(TIME)), None, free, (), CalibrationPolicy())  # type: ignore[arg-type]
    found = posterior_of(estimation, told.append)
    assert "start 2" in told
    assert found.point.u[0] == approx(TRUE, abs=1e-3)
    assert not found.leaves_gap
