"""What a reader is told of values that a model must assume to be off."""

from types import SimpleNamespace

import numpy as np
import pytest

from flexarm.diagnosis.fitting.projection import Projection
from flexarm.diagnosis.outcome import evidence_sentence, naming
from flexarm.diagnosis.outcome.evidence_sentence import _strained


def null_of(delay: float, modulus: float = 0.0):
    """A fit that is late by a multiple of the 2 ms that its clock may be, and soft by one of 2 GPa."""
    slopes = np.zeros((50, 2))
    slopes[:25, 0], slopes[25:, 1] = 1e6, 1e-6
    each = (
        SimpleNamespace(key="effects.time_delay.tracker.delay", kind="clock"),
        SimpleNamespace(key="links.rod.material.youngs_modulus", kind="nominal"),
    )
    sigma = np.array([2e-3, 2e9])
    return SimpleNamespace(
        residual=-slopes[:, 0] * delay * 2e-3 - slopes[:, 1] * modulus * 2e9,
        projection=Projection(slopes, sigma),
        unknowns=SimpleNamespace(each=each, sigma=sigma),
    )


def test_a_clock_that_would_be_far_beyond_its_sigma_is_said():
    said = list(_strained(null_of(7.0), 3.0))
    assert said == ["the delay of clock tracker would be off by 7 times its stated sigma"]


def test_a_clock_within_its_sigma_is_not_worth_a_word():
    assert not list(_strained(null_of(1.5), 3.0))


@pytest.mark.parametrize("left, said, first", [((2.6, 2.6), True, 0.5), ((2.6, 1.0), False, 0.98)])
def test_a_name_beside_strained_values_is_doubted_and_the_reader_is_told_why(monkeypatch, left, said, first):
    """Two values at 2.6 sigmas are 1.2 beyond two in all, though neither is unusual by itself."""
    fit = null_of(left[0], left[1])
    member = SimpleNamespace(name="link_bow", at="rod", place=("link_bow", "rod"), free=("tip_offset.x",))
    fit.members, fit.coordinates, fit.z, fit.rest = (member,), (), (), fit.residual
    choice = SimpleNamespace(best=fit, null=null_of(0.0, 0.0), rivals=[[]], gain=50.0, value={})
    choice.null.rest = choice.null.residual
    monkeypatch.setattr(evidence_sentence, "above_noise", lambda rest, observed: {"tip": 1.0})
    [named] = naming.named_effects(choice, SimpleNamespace(effects=[()]), (), False, None)
    assert named.probability == first
    assert ("something else may be missing" in named.evidence) is said
