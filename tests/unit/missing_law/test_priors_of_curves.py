"""The prior of a curve's knots, and the sizes of it that data leave open."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from flexarm.diagnosis.fit import Projection
from flexarm.missing_law.gaussian import ColumnSpace, GaussianData, GaussianModel, matern_root
from flexarm.missing_law.law import knots_over
from flexarm.missing_law.policy import LawPolicy
from flexarm.missing_law.refit import curve_root, smooth_modes

KNOTS = np.linspace(-500.0, 700.0, 41)
POLICY = LawPolicy()


@pytest.mark.parametrize("length", POLICY.curve_lengths)
def test_any_straight_line_is_likely_beside_a_curve_of_any_length(length):
    """A line from -3 to 3 sizes is one deviation of the prior or less."""
    line = POLICY.line_prior * np.linspace(-1.0, 1.0, len(KNOTS))
    latent = np.linalg.lstsq(curve_root(KNOTS, length, POLICY), line, rcond=None)[0]
    assert latent @ latent <= 1 + 1e-9


def test_the_modes_hold_lines_and_curves_as_smooth_as_their_priors():
    modes = smooth_modes(KNOTS, POLICY)
    assert modes.T @ modes == pytest.approx(np.eye(modes.shape[1]), abs=1e-12)
    for curve in (KNOTS, np.sin(KNOTS / 200), np.exp(-((KNOTS / 300) ** 2))):
        rest = curve - modes @ (modes.T @ curve)
        assert np.abs(rest).max() < 3 * POLICY.least_mode * np.abs(curve).max()


def test_knots_of_a_rate_are_dense_where_it_changes_its_sign():
    rates = np.linspace(-0.8, 1.1, 500)
    knots = knots_over("rate", rates, POLICY)
    assert knots[0] < -0.8 and knots[-1] > 1.1
    steps = np.diff(knots)
    assert np.all(steps > 0)
    assert steps.max() / steps.min() == pytest.approx(np.cosh(POLICY.knot_density), rel=0.1)
    assert abs(knots[np.argmin(steps)]) < 0.05
    assert np.ptp(np.diff(knots_over("angle", rates, POLICY))) < 1e-12


def data(seed: int) -> tuple[GaussianData, np.ndarray]:
    """Forty values of a line and noise of size one, without nuisance parameters that matter."""
    rng = np.random.default_rng(seed)
    columns = rng.standard_normal((40, 6))
    y = columns @ rng.standard_normal(6) * 2 + rng.standard_normal(40)
    nuisance = Projection(1e-9 * rng.standard_normal((40, 1)), np.ones(1))
    return GaussianData(y, nuisance), columns


def test_sizes_within_reach_are_those_that_the_evidence_does_not_tell_apart():
    given, columns = data(2)
    best = GaussianModel.of(given, columns)
    likely = GaussianModel.likely(given, columns, 3.0)
    assert best.log_evidence == max(each.log_evidence for each in likely)
    assert all(each.log_evidence >= best.log_evidence - 3.0 for each in likely)
    sizes = [np.linalg.norm(each.factor) for each in likely]
    assert max(sizes) > 2 * min(sizes)


def test_a_posterior_without_nuisance_is_ridge_regression():
    """Mean of s xi: (A^T A + v/s^2)^-1 A^T y."""
    given, columns = data(3)
    model = GaussianModel.of(given, columns)
    size = np.linalg.norm(model.factor) / np.linalg.norm(columns)
    ridge = np.linalg.solve(columns.T @ columns + model.noise / size**2 * np.eye(6), columns.T @ given.y)
    assert size * model.posterior()[0] == pytest.approx(ridge, rel=1e-6)


def test_sparse_columns_have_the_normal_equations_of_dense_ones():
    """|P R|^2 and (P R)^T P y from what nuisance parameters explain, or of the projected columns."""
    rng = np.random.default_rng(4)
    columns = np.where(rng.uniform(size=(40, 6)) < 0.3, rng.standard_normal((40, 6)), 0.0)
    given = GaussianData(rng.standard_normal(40), Projection(rng.standard_normal((40, 3)), np.ones(3)))
    dense, sparse = ColumnSpace.of(given, columns), ColumnSpace.of(given, csr_matrix(columns))
    assert sparse.gram == pytest.approx(dense.gram, abs=1e-12)
    assert sparse.moment == pytest.approx(dense.moment, abs=1e-12)
    assert sparse.model(np.eye(6)).log_evidence == pytest.approx(dense.model(np.eye(6)).log_evidence)


def test_a_root_of_the_matern_covariance_has_its_variances():
    """Matern 5/2 at the distance of one length: (1 + sqrt(5) + 5/3) exp(-sqrt(5)) [Rasmussen2006, 4.17]."""
    root = matern_root(np.linspace(0.0, 10.0, 41), 5.0)
    covariance = root @ root.T
    assert np.diag(covariance) == pytest.approx(np.ones(41), abs=1e-8)
    assert covariance[0, 20] == pytest.approx((1 + 5**0.5 + 5 / 3) * np.exp(-(5**0.5)), abs=1e-8)
