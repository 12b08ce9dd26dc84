"""A fit with rows weighed by what they are worth: on a linear model, whose least squares are known."""

from types import SimpleNamespace

import numpy as np
import pytest

from flexarm.arm.prior import Prior
from flexarm.diagnosis.candidate import TransformedParameter, prior_rows
from flexarm.diagnosis.fit import Projection, gls_nuisance, gls_step

SIGMA = np.array([0.5, 2.0])


def linear_fit(gap: float) -> SimpleNamespace:
    """One effect and two unknowns fitted to 300 rows of noise and a gap that is partly none of them."""
    rng = np.random.default_rng(7)
    jacobian, nuisance = rng.normal(size=(300, 1)), rng.normal(size=(300, 2))
    lacking = gap * (nuisance @ [1.0, -0.6] + rng.normal(size=300))
    projection = Projection(nuisance, SIGMA)
    parameters = (TransformedParameter(0, "offset", Prior(-4.0, 4.0, 0.0, "uniform", "m", "made up")),)
    start = rng.normal(size=300) + lacking
    a = projection.project(jacobian)
    weak = prior_rows(parameters, np.zeros(1))[1]
    z = -np.linalg.solve(a.T @ a + np.diag(weak**2), a.T @ projection.project(start))
    residual = start + jacobian @ z
    rest = projection.project(residual)
    return SimpleNamespace(
        jacobian=jacobian,
        projection=projection,
        parameters=parameters,
        z=z,
        residual=residual,
        projected=rest,
        cost=float(rest @ rest),
    )


def least_squares(fit, weight):
    """All rows and priors as one problem, solved at once."""
    root = np.sqrt(weight)
    rows, bends = prior_rows(fit.parameters, fit.z)
    a = np.block(
        [
            [root[:, None] * fit.jacobian, root[:, None] * fit.projection.jacobian],
            [np.zeros((2, 1)), np.diag(1 / SIGMA)],
            [np.diag(bends), np.zeros((1, 2))],
        ]
    )
    return np.linalg.lstsq(a, -np.concatenate([root * fit.residual, np.zeros(2), rows]), rcond=None)[0]


def step_of(fit, weight):
    root = np.sqrt(weight)
    jacobian = np.column_stack([fit.jacobian, fit.projection.jacobian])
    return gls_step(fit, root[:, None] * jacobian, root * fit.residual)


def test_rows_that_count_in_full_leave_a_fit_where_it_is():
    assert np.abs(step_of(linear_fit(gap=3.0), np.ones(300))).max() == 0.0


def test_weighed_rows_move_it_to_their_own_least_squares():
    fit = linear_fit(gap=30.0)
    weight = np.where(np.arange(300) < 100, 1e-3, 1e-2)
    optimum = np.concatenate([np.zeros(1), fit.projection.solve(fit.residual)])
    assert optimum + step_of(fit, weight) == pytest.approx(least_squares(fit, weight), rel=1e-6)


def test_unknowns_beside_a_gap_stay_with_their_priors():
    """By its noise alone the fit takes them sixty sigmas away, after a gap that is none of theirs."""
    fit = linear_fit(gap=30.0)
    assert abs(fit.projection.solve(fit.residual) / SIGMA).max() > 30
    assert abs(gls_nuisance(fit) / SIGMA).max() < 10


def test_without_a_gap_they_are_where_the_fit_has_them():
    fit = linear_fit(gap=0.0)
    assert fit.cost < 1.2 * 300
    assert gls_nuisance(fit) == pytest.approx(fit.projection.solve(fit.residual), abs=0.02 * SIGMA.min())
