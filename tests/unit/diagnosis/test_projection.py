"""Least squares in which linear unknowns with priors are eliminated."""

import numpy as np
import pytest

from flexarm.diagnosis.fit import Projection

RNG = np.random.default_rng(3)


def augmented(jacobian, sigma, residual):
    """The same least squares with priors as rows."""
    known = np.isfinite(sigma)
    rows = np.vstack([jacobian, np.diag(np.where(known, 1.0 / sigma, 0.0))])
    right = np.concatenate([-residual, np.zeros(len(sigma))])
    best = np.linalg.lstsq(rows, right, rcond=None)[0]
    return best, float(np.sum((rows @ best - right) ** 2))


@pytest.mark.parametrize("sigma", [[0.1, 2.0, 0.5], [np.inf, 0.3, 1.0]])
def test_elimination_is_least_squares_with_priors_as_rows(sigma):
    jacobian, residual, sigma = RNG.normal(size=(40, 3)), RNG.normal(size=40), np.array(sigma)
    projection = Projection(jacobian, sigma)
    best, cost = augmented(jacobian, sigma, residual)
    rest = projection.project(residual)
    assert rest @ rest == pytest.approx(cost, rel=1e-12)
    assert projection.solve(residual) == pytest.approx(best, rel=1e-10)


def test_what_unknowns_explain_without_a_prior_leaves_nothing():
    jacobian = RNG.normal(size=(30, 2))
    projection = Projection(jacobian, np.array([np.inf, np.inf]))
    assert np.abs(projection.project(jacobian @ [3.0, -2.0])).max() < 1e-12


def test_a_column_of_zeros_keeps_its_prior():
    jacobian = np.column_stack([RNG.normal(size=20), np.zeros(20)])
    projection = Projection(jacobian, np.array([1.0, 0.7]))
    assert projection.solve(RNG.normal(size=20))[1] == pytest.approx(0.0, abs=1e-15)
    assert projection.covariance()[1, 1] == pytest.approx(0.7**2, rel=1e-12)


def test_covariance_is_that_of_repeated_noise():
    """Unknowns are as uncertain as noise and priors drawn anew make them; 4000 draws know that to 2 %."""
    jacobian, sigma = RNG.normal(size=(25, 2)), np.array([0.2, 5.0])
    projection = Projection(jacobian, sigma)
    true = sigma * RNG.normal(size=(4000, 2))
    found = np.array([projection.solve(-jacobian @ x + RNG.normal(size=25)) for x in true])
    error = np.cov((found - true).T)
    assert np.diag(projection.covariance()) == pytest.approx(np.diag(error), rel=0.1)
