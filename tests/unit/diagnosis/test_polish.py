"""Fits taken further, on objectives that are made up: how often, and which one comes out."""

from math import inf
from types import SimpleNamespace

import pytest

from flexarm.diagnosis import refinement as polish
from flexarm.errors import NotConverged

PROBLEM = SimpleNamespace(policy=None)
ABOUT = SimpleNamespace(problem=PROBLEM, with_effects=lambda members: members)
HONEST = SimpleNamespace(problem=PROBLEM, fit=lambda members: fit(1e9))
"""A fitter about a fit, which finds nothing better."""


def fit(objective):
    made = SimpleNamespace(objective=objective, cost=objective, residual=[0.0], members=("spring",))
    made.projected, made.non_smooth = [0.0], True
    return made


@pytest.fixture
def path(monkeypatch):
    """Steps lead along objectives that a test appends; what a fit says of itself is 0.5 too little."""
    objectives: list[float] = []

    def linearised(one, about):
        return (one, about) if about is HONEST else (fit(one.objective + 0.5), HONEST)

    def gauss_newton_step(one, about, anew, part, limit):
        assert limit == one.objective  # what is not less is not taken
        if not objectives:
            raise NotConverged("no equilibrium")
        return fit(objectives.pop(0)), HONEST

    monkeypatch.setattr(polish, "linearised", linearised)
    monkeypatch.setattr(polish, "gauss_newton_step", gauss_newton_step)
    monkeypatch.setattr(polish, "hooke_jeeves", lambda one, about: one.members)
    monkeypatch.setattr(polish, "objective", lambda one: one.objective)
    monkeypatch.setattr(polish, "predicted_decrease", lambda one: 0.0)
    monkeypatch.setattr(polish, "sigma_squared", lambda one: 1.0)
    monkeypatch.setattr(polish, "above_noise", lambda *_: {"run": inf})
    monkeypatch.setattr(polish, "is_non_smooth", lambda arm: True)
    return objectives


def test_a_step_is_judged_against_the_same_model_evaluated(path):
    """95 by its own account, 95.5 in truth: 95.3 is less, and the next 95.29 is where it rests."""
    path += [95.3, 95.29]
    assert polish.converged(fit(95.0), ABOUT)[0].objective == 95.29


def test_what_is_better_by_its_own_account_than_all_that_follows_stays(path, monkeypatch):
    """Beside corners unknowns do not act in proportion, and steps lead away: 100 in truth, then 95."""
    linearised = lambda one, about: (one, about) if about is HONEST else (fit(100.0), HONEST)  # noqa: E731
    monkeypatch.setattr(polish, "linearised", linearised)
    path += [95.0, 94.99, 94.98]
    start = fit(90.0)
    assert polish.converged(start, ABOUT) == polish.refined_while_better(start, ABOUT) == (start, ABOUT)


def test_without_corners_what_steps_lead_to_is_believed(path, monkeypatch):
    """There C is smooth, and 90 was only what unknowns would do in proportion from afar."""
    linearised = lambda one, about: (one, about) if about is HONEST else (fit(100.0), HONEST)  # noqa: E731
    monkeypatch.setattr(polish, "linearised", linearised)
    monkeypatch.setattr(polish, "is_non_smooth", lambda arm: False)
    path += [95.0, 94.99]
    assert polish.converged(fit(90.0), ABOUT)[0].objective == 94.99


def test_a_model_without_effects_takes_no_steps_and_stays_where_it_is_better(path, monkeypatch):
    """Springs a third of their tolerance off: about the model that they make more is left than they said."""
    monkeypatch.setattr(polish, "is_non_smooth", lambda arm: False)
    monkeypatch.setattr(polish, "linearised", lambda one, about: (fit(100.0), HONEST))
    start = SimpleNamespace(objective=90.0, members=())
    assert polish.converged(start, ABOUT) == (start, ABOUT)


def test_steps_end_where_they_bring_less_than_a_tenth_of_sigma_squared(path):
    path += [95.0, 94.95, 1.0]
    assert polish.converged(fit(99.0), ABOUT)[0].objective == 94.95
    assert path == [1.0]


def test_a_step_that_leads_up_gives_way_to_a_fit_about_the_same_model(path, monkeypatch):
    again = SimpleNamespace(problem=None, fit=lambda members: fit(97.0))
    monkeypatch.setattr(polish, "linearised", lambda one, about: (fit(100.0), again))
    path += [105.0]
    assert polish.refinement_step(fit(90.0), ABOUT)[0].objective == 97.0


def test_nothing_that_leads_up_is_taken(path, monkeypatch):
    again = SimpleNamespace(problem=None, fit=lambda members: fit(101.0))
    monkeypatch.setattr(polish, "linearised", lambda one, about: (fit(100.0), again))
    path += [105.0]
    assert polish.refinement_step(fit(90.0), ABOUT)[0].objective == 100.0


def test_what_cannot_be_simulated_further_stays_as_it_is(path, monkeypatch):
    def linearised(one, about):
        raise NotConverged("no equilibrium")

    monkeypatch.setattr(polish, "linearised", linearised)
    start = fit(90.0)
    assert polish.converged(start, ABOUT) == polish.refined_while_better(start, ABOUT) == (start, ABOUT)


def test_polishing_ends_after_two_rounds_that_bring_less_than_a_fiftieth(path):
    path += [60.0, 58.9, 57.8, 1.0]
    assert polish.refined_while_better(fit(90.0), ABOUT)[0].objective == 57.8


def test_a_step_that_overshoots_is_shortened(path, monkeypatch):
    """Where a step should lead far down and leads up, as arms swing out of step, a part of it may not."""
    monkeypatch.setattr(polish, "linearised", lambda one, about: (fit(100.0), HONEST))
    monkeypatch.setattr(polish, "predicted_decrease", lambda one: 90.0)
    path += [385.0, 120.0, 40.0]
    assert polish.refinement_step(fit(100.0), ABOUT)[0].objective == 40.0
    assert path == []


def test_a_step_that_would_lead_nowhere_is_not_shortened(path, monkeypatch):
    monkeypatch.setattr(polish, "linearised", lambda one, about: (fit(100.0), HONEST))
    monkeypatch.setattr(polish, "predicted_decrease", lambda one: 0.5)
    path += [100.1, 99.0]
    assert polish.refinement_step(fit(100.0), ABOUT)[0].objective == 100.0
    assert path == [99.0]
