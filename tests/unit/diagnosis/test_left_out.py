"""What a model misses where it was not fitted."""

from types import SimpleNamespace

import numpy as np
import pytest

from flexarm.diagnosis.cross_validation import folds, predicts_better, press_residuals, press_rms
from flexarm.diagnosis.fit import Projection
from flexarm.diagnosis.policy import SelectionPolicy

RNG = np.random.default_rng(23)
EACH = 6


def problem(records, kind="static"):
    rows = [
        SimpleNamespace(
            record=f"day {k}",
            signal="tip",
            channel=0,
            where=slice(EACH * k, EACH * (k + 1)),
            time=np.arange(EACH, dtype=float),
        )
        for k in range(records)
    ]
    named = {row.record: SimpleNamespace(kind=kind) for row in rows}
    return SimpleNamespace(
        rows=rows,
        records=named,
        channels=lambda: [(row, row.where) for row in rows],
        policy=SelectionPolicy(),
    )


def least_squares(jacobian, y, sigma, rows=slice(None)):
    """x of min |y + J x|^2 + |x/sigma|^2 over some rows."""
    j = jacobian[rows]
    return -np.linalg.solve(j.T @ j + np.diag(sigma**-2.0), j.T @ y[rows])


def fit_of(jacobian, y, sigma):
    """Unknowns alone: a fit at the centres of their priors, from where they go to the optimum."""
    projection = Projection(jacobian, sigma)
    empty = np.empty((len(y), 0))
    return SimpleNamespace(z=np.zeros(0), parameters=(), jacobian=empty, residual=y, projection=projection)


def test_a_group_is_missed_as_by_a_fit_to_all_others():
    """Eq. (1) is exact where the model is linear: beside a fit that is made anew for each group."""
    records = 5
    jacobian = RNG.normal(size=(EACH * records, 3))
    y, sigma = RNG.normal(size=EACH * records), np.array([0.3, 1.0, 50.0])
    found = press_residuals(fit_of(jacobian, y, sigma), problem(records))
    for rows in folds(problem(records)):
        x = least_squares(jacobian, y, sigma, np.setdiff1d(np.arange(len(y)), rows))
        assert found[rows] == pytest.approx(y[rows] + jacobian[rows] @ x, abs=1e-9)


def test_what_a_record_alone_knows_is_known_when_a_part_of_it_is_left_out():
    """A frame for each record: five of six poses place it, to 1/5 of their variance."""
    records = 12
    noise = RNG.normal(size=EACH * records)
    frames = np.repeat(np.eye(records), EACH, axis=0)
    placed = fit_of(frames, noise + 50.0 * frames @ RNG.normal(size=records), np.full(records, 1e3))
    assert press_rms(placed, problem(records)) == pytest.approx(np.sqrt(1.2), rel=0.2)


def test_each_record_falls_into_stretches():
    assert [rows.tolist() for rows in folds(problem(2))] == [[k] for k in range(12)]
    assert len(folds(problem(2, "motion"))) == 2 * EACH


@pytest.mark.parametrize(
    ("groups", "left", "clear"), [(6, 0.7, False), (6, 0.4, True), (24, 0.7, True), (96, 0.85, False)]
)
def test_odds_grow_with_the_groups_that_are_foretold(groups, left, clear):
    """G ln(|e'|/|e|): 6 ln(1/0.7) = 2.1, 6 ln(1/0.4) = 5.5, 24 ln(1/0.7) = 8.6; and a fifth at least."""
    records = groups // EACH
    y = RNG.normal(size=EACH * records)
    empty = np.empty((len(y), 0)), np.empty(0)
    one, other = (fit_of(empty[0], size * y, empty[1]) for size in (left, 1.0))
    assert predicts_better(one, other, problem(records)) == clear
    assert not predicts_better(other, one, problem(records))
