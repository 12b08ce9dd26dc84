"""One model that cannot be simulated ends no diagnosis; an error of the program does."""

import dataclasses
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.linalg import LinAlgError

from flexarm.arm.prior import Prior
from flexarm.diagnosis import alternatives, selection
from flexarm.diagnosis import refinement as polish
from flexarm.diagnosis import screening as screen
from flexarm.diagnosis import selection as choose
from flexarm.diagnosis.acceptance import Criteria
from flexarm.diagnosis.candidate import TransformedParameter
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.moves import confounding
from flexarm.diagnosis.moves import proposals as promising
from flexarm.diagnosis.nuisance import NuisanceModel, NuisanceParameter
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.errors import InvalidParameter, NotConverged

FAILURES = [
    NotConverged("no equilibrium"),
    InvalidParameter("mass must be positive"),
    LinAlgError("singular"),
]
NOTHING = SimpleNamespace(members=(), cost=9.0)
CRITERIA = Criteria(SimpleNamespace(policy=SelectionPolicy()), NOTHING)


def raises(*_):
    raise NotConverged("no equilibrium")


def failing(error, at):
    """A fitter that finds everything but one thing."""

    def trial(members, nearby, limit):
        if members[0] == at:
            raise error
        return SimpleNamespace(name=members[0], cost=1.0)

    return SimpleNamespace(trial=trial, problem=None)


def fitted(error, monkeypatch):
    """What is found of three effects, of which the second leads to an error."""
    monkeypatch.setattr(Criteria, "explains", lambda *_: False)
    shares = [SimpleNamespace(members=(name,), share=0.9) for name in ("tilt", "bow", "play")]
    return [fit.name for fit in promising.fitted(failing(error, "bow"), shares, NOTHING, CRITERIA)]


@pytest.mark.parametrize("error", FAILURES, ids=lambda error: type(error).__name__)
def test_what_cannot_be_fitted_is_left_out(error, monkeypatch):
    assert fitted(error, monkeypatch) == ["tilt", "play"]


def test_arrays_that_do_not_fit_together_are_no_model_that_cannot_be_simulated(monkeypatch):
    """What NumPy says of them is a ValueError, as an InvalidParameter is."""
    with pytest.raises(ValueError, match="broadcast"):
        fitted(ValueError("operands could not be broadcast together"), monkeypatch)


def test_a_value_that_has_no_logarithm_is_refused_by_name():
    mass = TransformedParameter(0, "mass", Prior(1.0, 4.0, 2.0, "log", "kg", "a test"))
    with pytest.raises(InvalidParameter, match="mass must be positive, got 0 kg"):
        mass.z(0.0)


@dataclass(eq=False)
class Made:
    """As much of a fit as the steps of a search ask for; its effects are letters."""

    name: str
    cost: float = 1.0

    @property
    def places(self):
        return tuple((each, "hinge") for each in self.name)

    @property
    def spots(self):
        return frozenset(self.places)

    @property
    def members(self):
        return tuple(
            SimpleNamespace(place=place, spots={place}, required_place=None) for place in self.places
        )


def test_values_stay_where_they_are_stated_if_no_other_model_can_be_simulated():
    modulus = NuisanceParameter("links.rod.material.youngs_modulus", 2e11, 2e9, "Pa", "nominal")
    lower = SimpleNamespace(solve_within=lambda residual, reach: np.array([-1e9]))
    fit = SimpleNamespace(cost=9.0, residual=None, members=(), projection=lower)
    estimator = SimpleNamespace(
        nuisance=NuisanceModel(None, (modulus,)), fit=lambda members: fit, _moved=raises
    )
    assert Estimator.centred(estimator) is estimator


def test_the_model_without_effects_stays_where_no_derivatives_can_be_taken():
    start, estimator = Made(""), SimpleNamespace(about=raises)
    assert polish.fitted_null(start, estimator) == (start, estimator)


@pytest.mark.parametrize("failing", ["a", "b"])
def test_a_model_without_derivatives_of_its_own_is_judged_as_it_is(failing, monkeypatch):
    """ "a" comes first and "b" close; about itself each leaves a tenth of what it left before."""
    for judged in ("reduces", "leaves_gap", "in_conflict"):
        monkeypatch.setattr(Criteria, judged, lambda *_: False)
    monkeypatch.setattr(selection, "log_bayes_factor", lambda one, other, _: other.cost - one.cost)
    monkeypatch.setattr(selection, "refined_while_better", lambda fit, about: (fit, about))

    def again(_, nearby):
        return Made(nearby.name, nearby.cost / 10)

    def about(fit):
        return raises() if fit.name == failing else SimpleNamespace(fit=again)

    estimator = SimpleNamespace(about=about, problem=None)
    best, there = selection.best_of(estimator, [Made("a", 1.0), Made("b", 2.0)], None, CRITERIA)
    assert (best.name, best.cost) == {"a": ("b", 0.2), "b": ("a", 0.1)}[failing]
    alone, there = selection.best_of(estimator, [Made(failing, 1.0)], None, CRITERIA)
    assert (alone.cost, there) == (1.0, estimator)


def test_a_needless_effect_is_dropped_though_no_derivatives_can_be_taken_without_it(monkeypatch):
    monkeypatch.setattr(Criteria, "accepts", lambda *_: False)
    estimator = SimpleNamespace(fit=lambda *_, **__: Made("b"), about=raises, problem=None)
    best, there = choose.backward(CRITERIA, Made("ab"), estimator)
    assert (best.name, there) == ("b", estimator)


def test_where_no_small_steps_can_be_taken_clocks_and_frames_take_over_all_the_same(monkeypatch):
    """They need no simulation; what else could take over is asked of the fit in longer steps."""
    monkeypatch.setattr(
        confounding, "linear_response", lambda candidate, *_: None if candidate.at == "rod" else 1
    )
    law = SimpleNamespace(is_wave=False, is_spring=False)
    probed = [
        SimpleNamespace(candidate=SimpleNamespace(place=at, at=at, spots={at}, effect=law, needs=None))
        for at in ("rod", "tracker")
    ]
    nuisance = SimpleNamespace(keys=[], parameters=[SimpleNamespace(kind="nominal", key="modulus")])
    projection = SimpleNamespace(jacobian=None)
    best = SimpleNamespace(members=(), spots=set(), nuisance=nuisance, projection=projection)
    problem = SimpleNamespace(step=1e-3, with_step=lambda step: SimpleNamespace(jacobian=raises))
    steps = SimpleNamespace(steps=lambda arm: {})
    estimator = SimpleNamespace(problem=problem, nuisance=steps, with_effects=lambda members: None)
    found = confounding._moves(estimator, probed, best, {"modulus": (np.ones(3), 1.0)})
    assert [candidate.at for candidate, *_ in found] == ["tracker"]


def test_rivals_are_looked_for_beside_a_model_that_was_tried_where_none_can_be_fitted():
    """The others without the chosen effect; None if these were never tried by themselves."""
    estimator = SimpleNamespace(fit=raises)
    tried = [Made(""), Made("a"), Made("ab")]
    assert alternatives.without((), estimator, tried) is tried[0]
    assert alternatives.without(Made("a").members, estimator, tried) is tried[1]
    assert alternatives.without(Made("b").members, estimator, tried) is None


def test_what_cannot_follow_longer_steps_is_looked_at_in_those_of_fits(monkeypatch):
    """As hysteresis that sticks within a tenth of a milliradian: shares are taken anew all the same."""
    estimator = SimpleNamespace(
        problem=SimpleNamespace(step=4e-3, with_step=lambda step: None),
        with_effects=lambda members: None,
        eliminated=lambda members: (None, SimpleNamespace(project=lambda columns: columns)),
        residual=lambda members: np.array([0.0, 1.0 - 0.5 * len(members)]),
    )
    coarse = SimpleNamespace(problem=SimpleNamespace(prepare=lambda arms: None), residual=raises)
    monkeypatch.setattr(
        screen, "replace", lambda one, **new: coarse if "problem" in new else dataclasses.replace(one, **new)
    )
    fit = SimpleNamespace(members=(), residual=np.array([0.0, 1.0]), cost=1.0)
    [found] = screen.rescreened_at_size(estimator, [screen.Share(("bow",), 0.5)], fit)
    assert found.share == pytest.approx(1.0)  # twice the size takes all
