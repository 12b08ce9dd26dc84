"""What a reader is told of values that a model must assume to be off."""

from types import SimpleNamespace

import numpy as np

from flexarm.diagnosis.fitting.projection import Projection
from flexarm.diagnosis.outcome.evidence_sentence import _strained


def null_of(delay: float):
    """A fit that is late by a multiple of the 2 ms that its clock may be; of a modulus data say nothing."""
    slopes = np.zeros((50, 2))
    slopes[:, 0] = 1e6
    each = (
        SimpleNamespace(key="effects.time_delay.tracker.delay", kind="clock"),
        SimpleNamespace(key="links.rod.material.youngs_modulus", kind="nominal"),
    )
    sigma = np.array([2e-3, 2e9])
    return SimpleNamespace(
        residual=-slopes[:, 0] * delay * 2e-3,
        projection=Projection(slopes, sigma),
        unknowns=SimpleNamespace(each=each, sigma=sigma),
    )


def test_a_clock_that_would_be_far_beyond_its_sigma_is_said():
    said = list(_strained(null_of(7.0)))
    assert said == ["the delay of clock tracker would be off by 7 times its stated sigma"]


def test_a_clock_within_its_sigma_is_not_worth_a_word():
    assert not list(_strained(null_of(1.5)))
