"""The repaired model: values as files show them, never beyond what is allowed."""

from types import SimpleNamespace

import diagnoses

import flexarm
from flexarm.diagnosis import verification
from flexarm.diagnosis.candidate import Candidate
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.uncertainty import Estimates
from flexarm.diagnosis.verification import repaired
from flexarm.effects.link_damping import LinkDamping
from flexarm.named_effects import Estimate, Refined


def repaired_with(ratio: float, std: float, *refined: Refined) -> flexarm.Arm:
    """The model that is written of what a fit found: a damping ratio, and nominal values."""
    damped = Candidate(LinkDamping(at="rod"), ("damping_ratio",), (), {})
    fit = SimpleNamespace(members=(damped,), places=(damped.place,))
    found = Estimate("damping_ratio", ratio, std, ratio - std, ratio + std, "-")
    return repaired(diagnoses.nominal(), fit, Estimates([(found,)], (), refined))


def ratio_in(arm: flexarm.Arm) -> float:
    """Of the link's damping."""
    return arm.effect("link_damping", "rod").damping_ratio


def test_values_show_a_thousandth_of_their_standard_deviation():
    assert ratio_in(repaired_with(0.123456789, 0.02)) == 0.12346


def test_a_value_that_would_be_rounded_beyond_its_limit_stays_as_it_is():
    """A ratio is below one, and 0.9999999 with a sigma of one is 1.000 to a thousandth of it."""
    assert ratio_in(repaired_with(0.9999999, 1.0)) == 0.9999999


def test_a_nominal_value_of_which_little_is_known_is_not_rounded_to_nothing():
    """To a thousandth of ten times itself a modulus would be zero."""
    modulus = Refined("links.rod.material.youngs_modulus", 1.0e8, 1e12, 2.1e11, "Pa")
    arm = repaired_with(0.01, 1e-3, modulus)
    assert arm.link("rod").material.youngs_modulus == 1.0e8
    assert ratio_in(arm) == 0.01


def test_a_repair_is_held_against_the_model_as_it_is_stated(monkeypatch):
    """And not against one whose modulus makes up for what is missing."""
    stated, asked = object(), []
    null, best = SimpleNamespace(residual=object()), SimpleNamespace(members=("spring",))
    choice = SimpleNamespace(best=best, null=null, estimator=SimpleNamespace(nominal_residual=lambda: stated))
    monkeypatch.setattr(verification, "press_rms", lambda *_: 1.0)
    monkeypatch.setattr(
        verification, "cross_validated_skill", lambda best, null, residual, _: asked.append(residual) or 1.0
    )
    assert verification.worth_keeping(choice, SimpleNamespace(policy=SelectionPolicy()))
    assert asked == [stated]
