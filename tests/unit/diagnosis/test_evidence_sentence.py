"""What a reader is told of values that a model must assume to be off."""

from types import SimpleNamespace

import numpy as np
import pytest

from flexarm.arm.prior import Prior
from flexarm.diagnosis import naming
from flexarm.diagnosis import naming as evidence_sentence
from flexarm.diagnosis.candidate import TransformedParameter
from flexarm.diagnosis.fit import Projection
from flexarm.diagnosis.naming import _behind, _conflict_clause
from flexarm.diagnosis.nuisance import NuisanceParameter
from flexarm.diagnosis.policy import SelectionPolicy


def null_of(delay: float, modulus: float = 0.0):
    """A fit that is late by a multiple of the 2 ms that its clock may be, and soft by one of 2 GPa."""
    jacobian = np.zeros((50, 2))
    jacobian[:25, 0], jacobian[25:, 1] = 1e6, 1e-6
    each = (
        NuisanceParameter("effects.time_delay.tracker.delay", 0.0, 2e-3, "s", "clock"),
        NuisanceParameter("links.rod.material.youngs_modulus", 2.1e11, 2e9, "Pa", "nominal"),
    )
    sigma = np.array([2e-3, 2e9])
    return SimpleNamespace(
        residual=-jacobian[:, 0] * delay * 2e-3 - jacobian[:, 1] * modulus * 2e9,
        projection=Projection(jacobian, sigma),
        nuisance=SimpleNamespace(parameters=each, sigma=sigma),
        non_smooth=False,
    )


def test_a_clock_that_would_be_far_beyond_its_sigma_is_said():
    said = _conflict_clause(null_of(7.0), 3.0)
    assert said == "the delay of clock tracker would be off by 7.0 times its stated sigma"


def test_unknowns_have_words_of_their_own():
    keys = {
        "links.rod.material.youngs_modulus": ("nominal", "value links.rod.material.youngs_modulus"),
        "effects.frame_registration.lab.rotation.y": ("frame", "rotation.y of frame lab"),
        "records.day.2.start.hinge 0.2 s 0 s": ("start", "vibration with which day.2 begins"),
    }
    assert all(
        NuisanceParameter(key, 1.0, 1.0, "", kind).words == words for key, (kind, words) in keys.items()
    )


def test_a_clock_within_its_sigma_is_not_worth_a_word():
    assert not _conflict_clause(null_of(1.5), 3.0)


@pytest.fixture
def named(monkeypatch):
    """What is said of a bow beside two values that are off by so many sigmas."""
    monkeypatch.setattr(evidence_sentence, "above_noise", lambda rest, problem, non_smooth: {"tip": 1.0})
    return _named


def _named(left, coarse=False, needed=50.0, share=None, part_of_bound=None):
    fit = null_of(left[0], left[1])
    effect = SimpleNamespace(parameters=tuple, shape=(), may_vanish=False)
    member = SimpleNamespace(
        name="link_bow",
        at="rod",
        place=("link_bow", "rod"),
        spots={("link_bow", "rod")},
        free=("tip_offset.x",),
        held=list,
        effect=effect,
        is_size=lambda name: True,
    )
    fit.members, fit.parameters, fit.z, fit.projected = (member,), (), (), fit.residual
    if part_of_bound is not None:
        offset = TransformedParameter(0, "tip_offset.x", Prior(-1e-3, 1e-3, 0.0, "linear", "m", "a test"))
        fit.parameters, fit.z = (offset,), (part_of_bound * offset.bound,)
    choice = SimpleNamespace(
        best=fit, null=null_of(0.0, 0.0), alternatives=[[]], gain=50.0, needed=[needed], shares=[share]
    )
    choice.null.projected = choice.null.residual
    problem = SimpleNamespace(arm=SimpleNamespace(effect=lambda name, at: None), policy=SelectionPolicy())
    [found] = naming.named_effects(
        choice, SimpleNamespace(effects=[()]), (), share is not None, problem, coarse
    )
    return found


@pytest.mark.parametrize("left, said", [((2.6, 2.6), True), ((2.6, 1.0), False)])
def test_beside_strained_values_a_name_keeps_its_probability_and_the_reader_is_told(named, left, said):
    """Two values at 2.6 sigmas are 1.2 beyond two in all, though neither is unusual by itself."""
    found = named(left)
    assert found.probability == SelectionPolicy.most_certain
    assert ("something else may be missing" in found.evidence) is said


@pytest.mark.parametrize(("share", "first"), [(0.9996, 0.98), (0.25, 0.25)])
def test_beside_a_gap_a_name_is_as_sure_as_the_part_that_it_explains(named, monkeypatch, share, first):
    """An offset of 2 mrad beside 0.04 mrad is certain, what explains a quarter may imitate its cause."""
    monkeypatch.setattr(evidence_sentence, "press_rms", lambda fit, problem: 1.0)
    assert named((0.0, 0.0), share=share).probability == first


def test_a_name_beside_a_coarse_encoder_is_doubted_and_the_reader_is_told_why(named):
    """What is lost between two counts shakes the arm; a damping seventy times the usual stood for it once."""
    found = named((0.0, 0.0), coarse=True)
    assert found.probability == 0.5
    assert found.evidence.endswith("so that it is at most as likely as not.")


@pytest.mark.parametrize(("part", "first"), [(1.0, 0.5), (0.3, SelectionPolicy.most_certain)])
def test_a_size_that_rests_where_fits_end_is_at_most_as_likely_as_not(named, part, first):
    """A forearm that hardens was told as one thirty times as stiff, at 0.98."""
    assert named((0.0, 0.0), part_of_bound=part).probability == first


def test_a_name_is_as_sure_as_the_model_with_it_is_ahead_of_the_one_without(named):
    """e^1.6 to one, however much all effects together explain."""
    assert named((0.0, 0.0), needed=1.6).probability == pytest.approx(1 / (1 + np.exp(-1.6)))


@pytest.mark.parametrize(
    ("alternative", "gained", "told"),
    [
        (12.4, 50.0, "behind by a ln Bayes factor of 12"),
        (0.42, 50.0, "behind by a ln Bayes factor of 0.4"),
        (4010.0, 234.0, "far behind"),
    ],
)
def test_a_rival_is_told_no_farther_behind_than_no_effect_at_all(alternative, gained, told):
    """Factors of pairs do not add up; a rival that may be neutral cannot be worse than none."""
    assert _behind(alternative, gained) == told
