"""Which of several models comes first, on models that are made up: costs, what they miss, their evidence."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from flexarm.budget import limited
from flexarm.diagnosis import alternatives, cross_validation, selection
from flexarm.diagnosis.acceptance import Criteria, implausibility
from flexarm.diagnosis.policy import SelectionPolicy


@dataclass(eq=False)
class Made:
    """As much of a fit as ranking asks for, and what is said of it."""

    name: str
    cost: float
    press_rms: float
    evidence: float = 0.0
    gap: bool = True
    odd: float = 0.0
    left: tuple[float, ...] = (0.0, 0.0)

    @property
    def places(self):
        return ((self.name, "hinge"),)

    @property
    def members(self):
        alone = {"acting_as": lambda other: None, "shaped_as": lambda other: None}
        return (SimpleNamespace(place=self.places[0], **alone),)

    @property
    def projected(self):
        return np.array(self.left)


@pytest.fixture(autouse=True)
def made_up(monkeypatch):
    for module in (selection, alternatives):
        monkeypatch.setattr(
            module, "log_bayes_factor", lambda one, other, problem: one.evidence - other.evidence
        )
    monkeypatch.setattr(cross_validation, "press_rms", lambda fit, problem: fit.press_rms)
    monkeypatch.setattr(cross_validation, "folds", lambda problem: range(24))
    monkeypatch.setattr(selection, "implausibility", lambda fit: fit.odd)
    monkeypatch.setattr(Criteria, "leaves_gap", lambda self, fit: fit.gap)
    monkeypatch.setattr(Criteria, "reduces", lambda self, new, old: new.cost < 0.97 * old.cost)


NULL = Made("nothing", cost=100.0, press_rms=10.0)


class Observed(SimpleNamespace):
    """As much of a problem: two rows."""

    def __len__(self):
        return 2


OBSERVED = Observed(policy=SelectionPolicy())
CRITERIA = Criteria(OBSERVED, NULL)


def ranked(*fits):
    return [fit.name for fit in selection._ranked(fits, NULL, CRITERIA)]


def test_beside_gaps_what_foretells_best_comes_first():
    """A late command fits what is worth most by noise and correlation; friction says more of other days."""
    late = Made("time_delay", cost=60.0, press_rms=8.0, evidence=900.0)
    rubs = Made("motor_friction", cost=50.0, press_rms=6.0, evidence=400.0)
    assert ranked(late, rubs) == ["motor_friction", "time_delay"]


def test_what_foretells_as_well_is_told_by_evidence():
    """A gap leans a boom as a tilted base does; 6.0 and 6.1 in 24 groups are odds of 1.5."""
    gap = Made("backlash", cost=50.0, press_rms=6.0, evidence=3.0)
    tilt = Made("base_tilt", cost=51.0, press_rms=6.1, evidence=9.0)
    assert ranked(gap, tilt) == ["base_tilt", "backlash"]


def test_when_time_is_over_evidence_ranks():
    """Fits that have not come to rest foretell badly, and strain values: here e^24 worse than the other."""
    family = Made("joint_tilt_compliance", cost=30.0, press_rms=8.0, evidence=900.0, odd=19.0)
    single = Made("joint_compliance", cost=60.0, press_rms=3.0, evidence=400.0)
    assert ranked(family, single)[0] == "joint_compliance"
    with limited(1e-9):
        assert ranked(family, single)[0] == "joint_tilt_compliance"


def test_absurd_values_must_foretell_far_better():
    """Thirty times a mass is 19 in ln p; 8.0 and 7.0 in 24 groups are odds of e^3.2, 8.0 and 3.0 of e^24."""
    springs = Made("joint_compliance", cost=60.0, press_rms=8.0, evidence=1.0)
    heavy = Made("link_mass", cost=50.0, press_rms=7.0, evidence=9.0, odd=19.0)
    assert ranked(heavy, springs) == ["joint_compliance", "link_mass"]
    right = Made("link_mass", cost=50.0, press_rms=3.0, odd=19.0)
    assert ranked(right, springs) == ["link_mass", "joint_compliance"]


def test_plausibility_counts_effects_and_unknowns_in_their_sigmas():
    prior, unknown = SimpleNamespace(scale="log"), SimpleNamespace(scale="uniform")
    fit = SimpleNamespace(
        z=[3.0, 5.0],
        parameters=[SimpleNamespace(prior=prior), SimpleNamespace(prior=unknown)],
        projection=SimpleNamespace(solve=lambda residual: np.array([0.0, 20.0])),
        residual=None,
        nuisance=SimpleNamespace(sigma=np.array([1.0, 2.0])),
    )
    assert implausibility(fit) == pytest.approx(2 * np.log(1 + 9 / 3) + 2 * np.log(1 + 100 / 3))


def test_what_leaves_all_but_two_percent_stands_back():
    rate = Made("clock_drift", cost=98.0, press_rms=4.0)
    rubs = Made("motor_friction", cost=50.0, press_rms=6.0)
    assert ranked(rate, rubs) == ["motor_friction"]
    assert ranked(rate) == ["clock_drift"]  # nothing else is there


def test_where_one_explains_all_evidence_ranks():
    right = Made("backlash", cost=1.0, press_rms=1.1, evidence=50.0, gap=False)
    other = Made("cable_torque", cost=1.2, press_rms=1.0, evidence=20.0, gap=False)
    assert ranked(other, right) == ["backlash", "cable_torque"]


def test_what_strains_values_is_taken_on_before_it_is_judged(monkeypatch):
    """Derivatives about a mass 40 sigmas off left a load's inertia a third behind an eccentricity."""
    costs = {"payload_inertia": [12.0, 11.0, 10.9], "encoder_eccentricity": [11.5]}
    strained = {"payload_inertia": 19.0, "link_mass": 30.0}

    def relinearised(fit, estimator):
        left = costs[fit.name]
        return Made(fit.name, left.pop(0) if left else fit.cost, 1.0, 50.0 - fit.cost, gap=False), estimator

    monkeypatch.setattr(selection, "relinearised", relinearised)
    monkeypatch.setattr(Criteria, "conflict", lambda self, fit: strained.get(fit.name, 0.0))
    monkeypatch.setattr(selection, "refined_while_better", lambda fit, about: (fit, about))
    far = lambda one, other, _: np.copysign(np.inf, other.cost - one.cost)  # noqa: E731
    monkeypatch.setattr(selection, "log_bayes_factor", far)
    fits = [
        Made("encoder_eccentricity", 12.0, 1.0, gap=False),
        Made("payload_inertia", 18.0, 1.0, gap=False),
        Made("link_mass", 90.0, 1.0, gap=False),  # does less than half: not asked
    ]
    best, _ = selection.best_of(SimpleNamespace(problem=OBSERVED), fits, NULL, CRITERIA)
    assert (best.name, best.cost) == ("payload_inertia", 10.9)


def test_beside_a_gap_only_what_explains_about_as_much_is_taken_anew(monkeypatch):
    """Of 100 the first leaves 40: what leaves more than (1 + 1/10) 40 + (100 - 40)/4 = 59 stays as it is.

    So does what leaves the same, to a tenth, as another one that is taken anew.
    """
    anew = []
    monkeypatch.setattr(
        selection, "relinearised", lambda fit, estimator: (anew.append(fit.name) or fit, estimator)
    )
    monkeypatch.setattr(selection, "refined_while_better", lambda fit, about: (fit, about))
    monkeypatch.setattr(selection, "press_rms", lambda fit, problem: fit.press_rms)
    fits = [
        Made("first", 40.0, 4.0, left=(1.0, 0.0)),
        Made("as the first", 41.0, 5.0, left=(1.0, 0.05)),
        Made("near", 58.0, 6.0, left=(0.0, 1.0)),
        Made("as the near one", 58.0, 6.1, left=(0.05, 1.0)),
        Made("another", 58.0, 6.2, left=(1.0, 1.0)),
        Made("far", 60.0, 6.0, left=(-1.0, 1.0)),
    ]
    selection.best_of(SimpleNamespace(problem=OBSERVED), fits, NULL, CRITERIA)
    assert anew == ["first", "near", "another"]


def test_what_came_close_on_the_way_is_a_rival():
    """Though screening sees little in it; what is thirty behind is none."""
    best = Made("joint_compliance", cost=1.0, press_rms=1.0, evidence=100.0)
    close, far = Made("joint_stiffening", 1.0, 1.0, 85.0), Made("cable_torque", 1.0, 1.0, 60.0)
    known = {fit.places[0]: fit for fit in (best, close, far)}
    assert [c.place for c in alternatives._near(known, [], best, OBSERVED)] == [("joint_stiffening", "hinge")]
    assert alternatives._near(known, list(close.members), best, OBSERVED) == []


def test_a_rival_is_taken_further_if_the_chosen_one_was_as_far_behind(monkeypatch):
    """Beside derivatives of the nominal model both are poor; the chosen one has come to rest since."""
    monkeypatch.setattr(alternatives, "predicted_decrease", lambda fit: 8.0)
    monkeypatch.setattr(
        alternatives,
        "refinement_step",
        lambda fit, about, anew: (Made("settled", 1.0, 1.0, 99.0), about),
    )
    about = SimpleNamespace(linearised=lambda members: Made("evaluated", 1.0, 1.0, 95.0))
    estimator = SimpleNamespace(problem=OBSERVED, about=lambda fit: about)
    best, first = (Made("gear_ratio", 1.0, 1.0, evidence) for evidence in (100.0, 41.0))
    alternative = Made("encoder_scale", 1.0, 1.0, 40.0)
    assert alternatives._refined_model(alternative, best, first, estimator, False)[0].name == "settled"
    assert alternatives._refined_model(alternative, best, best, estimator, False) == (alternative, 60.0)


@pytest.mark.parametrize("falls, steps", [(0.4, 0), (4.0, 1), (12.0, 1)])
def test_a_rival_takes_steps_that_could_bring_it_near(monkeypatch, falls, steps):
    """A fall of C by 4 is 2 of ln Z at most: from five behind that is worth a step, a fall by 0.4 is not."""
    taken = []
    monkeypatch.setattr(alternatives, "predicted_decrease", lambda fit: falls)
    monkeypatch.setattr(
        alternatives,
        "refinement_step",
        lambda fit, about, anew: (taken.append(fit) or Made("there", 1.0, 1.0, 95.0), about),
    )
    about = SimpleNamespace(linearised=lambda members: Made("evaluated", 1.0, 1.0, 95.0))
    estimator = SimpleNamespace(problem=OBSERVED, about=lambda fit: about)
    best, alternative = Made("gear_ratio", 1.0, 1.0, 100.0), Made("encoder_scale", 1.0, 1.0, 95.0)
    alternatives._refined_model(alternative, best, best, estimator, False)
    assert len(taken) == steps


def test_a_rival_that_no_step_could_bring_near_takes_none(monkeypatch):
    """Twenty behind, with a fall of C by 20 ahead: it would still be ten behind, out of sight."""
    monkeypatch.setattr(alternatives, "predicted_decrease", lambda fit: 20.0)
    monkeypatch.setattr(alternatives, "refinement_step", lambda *_, **__: pytest.fail("took a step"))
    about = SimpleNamespace(linearised=lambda members: Made("evaluated", 1.0, 1.0, 80.0))
    estimator = SimpleNamespace(problem=OBSERVED, about=lambda fit: about)
    best, alternative = Made("gear_ratio", 1.0, 1.0, 100.0), Made("encoder_scale", 1.0, 1.0, 80.0)
    assert alternatives._refined_model(alternative, best, best, estimator, False)[1] == 20.0


@pytest.mark.parametrize("gap, fitted", [(False, ["near"]), (True, ["near", "far"])], ids=["none", "a gap"])
def test_rivals_that_promise_far_less_are_fitted_beside_a_gap_alone(monkeypatch, gap, fitted):
    """A tenth of the best: what explains everything is not told by it, what leaves a gap may be."""
    made = {name: Made(name, 1.0, 1.0) for name in ("chosen", "near", "far")}
    shares = [
        SimpleNamespace(members=made[name].members, share=s) for name, s in (("near", 0.9), ("far", 0.09))
    ]
    monkeypatch.setattr(alternatives, "screen", lambda *_: shares)
    monkeypatch.setattr(alternatives, "out_of_step", lambda *_: False)
    monkeypatch.setattr(alternatives, "rescreened_at_size", lambda estimator, shares, fit: shares)
    monkeypatch.setattr(alternatives, "one_variant", lambda shares, most: shares)
    monkeypatch.setattr(Criteria, "leaves_gap", lambda *_: gap)
    monkeypatch.setattr(alternatives, "predicts_better", lambda *_: False)
    monkeypatch.setattr(alternatives, "log_likelihood_ratio", lambda *_: 0.0)
    monkeypatch.setattr(alternatives, "log_bayes_factor", lambda *_: 90.0)  # too far behind for a step
    nothing = SimpleNamespace(members=(), places=(), cost=9.0)
    estimator = SimpleNamespace(
        problem=OBSERVED, fit=lambda _: nothing, trial=lambda m, *_: made[m[0].place[0]]
    )
    told = []
    found = alternatives.alternatives_of(
        0,
        made["chosen"],
        Criteria(OBSERVED, nothing),
        estimator,
        [],
        [],
        lambda what, done: told.append(what),
    )
    assert [alternative.candidate.place[0] for alternative in found] == fitted
    assert told == [f"alternative {k} of {len(fitted)} to effect 1" for k in range(1, len(fitted) + 1)]


def test_a_rival_takes_the_free_shape_of_the_chosen_law_where_that_fits_better(monkeypatch):
    made = {"plain": Made("rival", 7.0, 1.0), "shaped": Made("rival", 3.0, 1.0)}
    shaped = SimpleNamespace(kind="shaped")
    rival = SimpleNamespace(
        place=("rival", "hinge"), kind="plain", acting_as=lambda _: None, shaped_as=lambda _: shaped
    )
    monkeypatch.setattr(alternatives, "screen", lambda *_: [])
    monkeypatch.setattr(alternatives, "_screened", lambda *_: [rival])
    monkeypatch.setattr(Criteria, "leaves_gap", lambda *_: True)
    kept = []
    monkeypatch.setattr(alternatives, "_refined_model", lambda fit, *_: (kept.append(fit) or fit, 0.0))
    monkeypatch.setattr(alternatives, "_alternative_model", lambda *_: SimpleNamespace(behind=0.0))
    nothing = SimpleNamespace(members=(), places=(), cost=9.0)
    estimator = SimpleNamespace(
        problem=OBSERVED, fit=lambda _: nothing, trial=lambda members, *_: made[members[0].kind]
    )
    alternatives.alternatives_of(0, Made("chosen", 1.0, 1.0), Criteria(OBSERVED, nothing), estimator, [], [])
    assert kept == [made["shaped"]]


def test_the_chosen_one_is_compared_as_it_was_tried():
    first, other = Made("gear_ratio", 7.5, 1.0), Made("encoder_scale", 7.5, 1.0)
    best = Made("gear_ratio", 6.8, 1.0)
    assert alternatives._as_tried(best, [first, other]) is first
    assert alternatives._as_tried(best, [other]) is best
