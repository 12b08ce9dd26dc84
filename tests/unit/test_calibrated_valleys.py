"""Intervals along a curved valley, against integrals in closed form."""

from dataclasses import dataclass, field

import numpy as np
import pytest
from pytest import approx

from flexarm.arrays import Floats
from flexarm.calibration.estimation import Estimation, Point, Posterior
from flexarm.calibration.intervals import marginals
from flexarm.calibration.parameters import FreeParameter
from flexarm.calibration.policy import CalibrationPolicy
from flexarm.calibration.valley import valley_of

SIGMA = 0.05
"""1 sigma of the datum u_1 - curvature u_0^2."""


@dataclass(frozen=True)
class White:
    """White noise and no other error."""

    input_errors: Floats = field(default_factory=lambda: np.empty((0, 1)))

    def root(self, values: Floats) -> Floats:
        return values

    def robust(self, jacobian: Floats, prior: Floats, inverse: Floats) -> Floats:
        return inverse

    covariance = robust


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
    estimation = Banana(None, None, free, (), CalibrationPolicy(), curvature)  # type: ignore[arg-type]
    point = estimation.linearised(np.zeros(2))
    H = point.jacobian.T @ point.jacobian + estimation.precision()
    inverse = np.linalg.inv(H)
    return Posterior(estimation, point, White(), inverse, inverse, np.full(2, last_move), 1)  # type: ignore[arg-type]


@pytest.mark.parametrize("k", [0, 1])
def test_a_bent_posterior_has_the_intervals_of_its_integral(k):
    """u_0 is N(0, 1) and u_1 given it N(u_0^2, 0.05^2): u_1 is chi-squared with one degree, but for noise."""
    rng = np.random.default_rng(1)
    u_0 = rng.standard_normal(400_000)
    exact = (u_0, u_0**2 + SIGMA * rng.standard_normal(len(u_0)))[k]
    found = marginals(bent := posterior(1.0))[k]
    assert valley_of(bent) is not None
    assert found.quantile(0.05) == approx(np.quantile(exact, 0.05), abs=0.05)
    assert found.quantile(0.95) == approx(np.quantile(exact, 0.95), abs=0.12)


def test_a_straight_posterior_stays_normal():
    assert valley_of(posterior(0.0)) is None
    [first, _] = marginals(posterior(0.0))
    assert first.quantile(0.95) == approx(1.645, abs=2e-3)


def test_no_valley_is_followed_from_estimates_that_are_not_at_rest():
    """Their intervals are normal about them: a profile from there has its minimum elsewhere."""
    moving = posterior(1.0, last_move=3.0)
    assert valley_of(moving) is None
    for found in marginals(moving):
        assert found.quantile(0.05) < 0.0 < found.quantile(0.95)
