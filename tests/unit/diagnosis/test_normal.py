"""Normal equations, beside those of the same numbers without units of their own."""

import numpy as np
import pytest

from flexarm.diagnosis.fit import NormalEquations

RNG = np.random.default_rng(31)
UNITS = np.array([1e-6, 1.0, 1e4])
SLOPES, WEIGHT = RNG.normal(size=(60, 3)) / UNITS, RNG.uniform(0.1, 1.0, 60)
PRIOR = np.array([4.0, 0.0, 0.5]) / UNITS**2


def hessian(rows):
    """S^-1 H S^-1 of rows, in the units of the parameters."""
    own = SLOPES[rows] * UNITS
    return own.T @ (WEIGHT[rows, None] * own) + np.diag(PRIOR * UNITS**2)


def test_the_inverse_is_that_of_the_weighed_rows_and_the_priors():
    """To twelve digits, though parameters differ by ten powers of ten."""
    normal, expected = NormalEquations.of(SLOPES, PRIOR, WEIGHT), np.linalg.inv(hessian(slice(None)))
    assert normal.inverse() / np.outer(UNITS, UNITS) == pytest.approx(expected, rel=1e-12)
    gradient = RNG.normal(size=3) / UNITS
    assert normal.solved(gradient) / UNITS == pytest.approx(expected @ (gradient * UNITS), rel=1e-11)


def test_rows_that_are_taken_away_were_never_there():
    less = NormalEquations.of(np.sqrt(WEIGHT)[:, None] * SLOPES, PRIOR).without(
        np.sqrt(WEIGHT[40:])[:, None] * SLOPES[40:]
    )
    expected = np.linalg.inv(hessian(slice(40)))
    assert less.inverse() / np.outer(UNITS, UNITS) == pytest.approx(expected, rel=1e-9)


def test_what_neither_rows_nor_priors_tell_stays_where_it_is():
    """Two parameters that act alike: the step is the shortest, half of it each; a third that does nothing."""
    column = RNG.normal(size=60)
    jacobian = np.column_stack([column, column, np.zeros(60)])
    step = NormalEquations.of(jacobian, np.zeros(3)).solved(jacobian.T @ (2.0 * column))
    assert step == pytest.approx([1.0, 1.0, 0.0], rel=1e-9)


def test_a_model_without_parameters_has_an_empty_inverse():
    assert NormalEquations.of(np.zeros((60, 0)), np.zeros(0)).inverse().shape == (0, 0)
