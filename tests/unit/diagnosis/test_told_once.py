"""What a reader is told is said once and does not contradict itself."""

from dataclasses import replace
from types import SimpleNamespace

import diagnoses
import numpy as np
import pytest

from flexarm.diagnosis import naming
from flexarm.diagnosis import naming as sentence
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.fit_statistics import PooledGap
from flexarm.named_effects import Alternative, NamedEffect
from flexarm.report.sentences import _change, headline, verdict_sentence


def plain(text: str) -> str:
    """On one line."""
    return " ".join(text.split())


def alternative(name: str, within_reach: bool, behind: float = 1.0) -> SimpleNamespace:
    place = (name, "hinge")
    candidate = SimpleNamespace(place=place, name=name, at="hinge")
    return SimpleNamespace(candidate=candidate, within_reach=within_reach, behind=behind)


def test_what_the_data_cannot_tell_from_a_named_effect_is_not_listed_as_rejected(monkeypatch):
    """Fitted alone on the way it may have been far behind; in the place of the named effect it is near."""
    monkeypatch.setattr(naming, "log_bayes_factor", lambda *_: -50.0)
    tried = SimpleNamespace(places=[("backlash", "hinge"), ("payload_mass", "hinge")])
    choice = SimpleNamespace(
        best=SimpleNamespace(places=[("joint_compliance", "hinge")]),
        alternatives=[[alternative("payload_mass", True), alternative("link_mass", False, 9.0)]],
        tried=[tried],
        value={},
    )
    found = naming.rejected(choice, SimpleNamespace(policy=SelectionPolicy()))
    assert [(each.name, each.why) for each in found] == [
        ("link_mass", naming.IN_ITS_PLACE),
        ("backlash", naming.ON_THE_WAY),
    ]


@pytest.mark.parametrize(
    ("probability", "other", "said"),
    [
        (0.85, 0.09, "which the data cannot tell from link stiffness at rod"),
        (0.98, 0.01, "where link stiffness at rod would fit as well, but with values that few machines have"),
    ],
)
def test_a_name_that_is_nearly_sure_is_not_called_one_that_cannot_be_told(probability, other, said):
    [effect] = diagnoses.of_effects().effects
    alternative = Alternative("link_stiffness", "rod", other)
    found = diagnoses.of_effects(
        effects=(replace(effect, probability=probability, alternatives=(alternative,)),)
    )
    assert said in verdict_sentence(found)
    assert ("cannot tell" in plain(found.summary())) is ("cannot tell" in said)


def test_an_effect_that_the_model_has_is_not_called_missing():
    """A spring of 140 kN m/rad where the model has 100 kN m/rad."""
    stated = diagnoses.nominal().replace(effects=())
    softer = stated.with_effect(diagnoses.JointCompliance(at="hinge", stiffness=1e5, damping=200.0))
    found = diagnoses.of_effects(arm=softer)
    assert headline(found) == "An effect of the model has other values than stated"
    assert "Missing from" not in found.summary()
    assert "In the model as stated: stiffness 100 kN m/rad and damping 200 N m s/rad." in plain(
        found.summary()
    )


def test_a_fault_is_described_once_in_the_summary():
    evidence = "in record 'a' tip x moves against the model."
    fault = NamedEffect("sign_error", "tip", 0.999, (), (), evidence)
    text = plain(replace(diagnoses.unusable(), effects=(fault,)).summary())
    assert text.count("tip x moves against the model") == 1
    assert "Repair the channel or leave it out of the record" in text


def test_refined_values_are_listed_once_where_they_are_many():
    found = diagnoses.adequate()
    text = verdict_sentence(replace(found, refined=5 * found.refined))
    assert "5 nominal values inside the stated uncertainty explain the gap" in text
    assert "(links.rod.material.youngs_modulus) explains the gap" in verdict_sentence(found)


BENCH = SimpleNamespace(arm=SimpleNamespace(effect=lambda name, at: None), policy=SelectionPolicy())
"""Records of a model without effects."""


def choice_of(names: list[str], before: float, after: float, monkeypatch) -> SimpleNamespace:
    """A choice of effects that takes the largest gap above the noise from one multiple of it to another."""
    sizes = {"null": {"tip": before}, "best": {"tip": after}}
    monkeypatch.setattr(sentence, "above_noise", lambda rest, problem, non_smooth: sizes[rest])
    unknown = SimpleNamespace(words="value E")
    pulls = {"null": 8.7, "best": 0.0}
    fits = {
        which: SimpleNamespace(
            projected=which,
            non_smooth=False,
            residual=which,
            members=[
                SimpleNamespace(name=name, at="hinge", spots={(name, "hinge")}, held=list) for name in names
            ],
            parameters=(),
            z=(),
            nuisance=SimpleNamespace(parameters=[unknown], sigma=np.ones(1)),
            projection=SimpleNamespace(solve=lambda residual: np.array([pulls[residual]])),
        )
        for which in ("null", "best")
    }
    return SimpleNamespace(**fits, alternatives=[[] for _ in names], needed=[39.4, 10865.2][: len(names)])


def test_of_several_effects_the_gap_is_told_once_and_the_evidence_of_each(monkeypatch):
    choice = choice_of(["joint_compliance", "backlash"], 34.0, 0.34, monkeypatch)
    first, second = (sentence.evidence_sentence(choice, k, (), False, BENCH) for k in (0, 1))
    assert first == (
        "with joint compliance at hinge and backlash at joint hinge the largest gap above the noise falls "
        "from 34 to 0.34 times the noise (ln Bayes factor 39 over the model without joint compliance at "
        "hinge); without them the value E would be off by 8.7 times its stated sigma."
    )
    assert second == (
        "beside joint compliance at hinge the data ask for backlash at joint hinge too (ln Bayes factor "
        "10865 over the model without it)."
    )


def test_an_effect_that_the_model_has_is_weighed_against_it_as_stated(monkeypatch):
    has = SimpleNamespace(arm=SimpleNamespace(effect=lambda name, at: name), policy=SelectionPolicy())
    told = sentence.evidence_sentence(choice_of(["backlash"], 34.0, 0.3, monkeypatch), 0, (), False, has)
    assert "(ln Bayes factor 39 over the model with it as stated)" in told


def test_a_gap_that_strained_values_close_as_well_is_not_said_to_stay(monkeypatch):
    """0.29 times the noise with the effect, 0.29 without: what differs is a modulus 8.7 sigmas off."""
    told = sentence.evidence_sentence(choice_of(["backlash"], 0.29, 0.29, monkeypatch), 0, (), False, BENCH)
    assert told == (
        "with clocks, frames and nominal values fitted along the largest gap above the noise is 0.29 times "
        "the noise, with backlash at joint hinge or without; but without it the value E would be off by 8.7 "
        "times its stated sigma (ln Bayes factor 39 over the model without it); if that sigma is too small, "
        "no effect is missing."
    )


def test_intervals_and_columns_say_what_they_are():
    text = diagnoses.of_effects(held_out=("other",)).summary()
    assert "rms before" in text and "max after" in text
    assert "other (held out)" in text
    assert "90 % interval" in text


@pytest.mark.parametrize(
    ("sizes", "said"),
    [
        ((6.3e-3, 6e-5, 5.7e-5), "shrinks from 6.30 mm to 0.0600 mm rms; sensor noise is 0.0570 mm."),
        ((0.31, 1.16e-4, 8.66e-5), "shrinks from 0.310 m to 0.116 mm rms; sensor noise is 0.0866 mm."),
        ((2e-3, 3e-3, None), "grows from 2.00 mm to 3.00 mm rms."),
        ((2e-3, 1.99e-3, None), "is 1.99 mm rms."),
        ((0.0, 0.0, None), "is 0 m rms."),
    ],
)
def test_a_gap_has_one_unit_unless_a_thousandth_is_left(sizes, said):
    assert _change(PooledGap(*sizes, None, None), "m") == said


@pytest.mark.parametrize(("sigmas", "first"), [(-3.6, True), (2.4, False)])
def test_a_nominal_value_beyond_three_sigmas_is_said_first(sigmas, first):
    """The modulus is stated within 1 %: 70 GPa that becomes 67.5 GPa is no refinement in silence."""
    found = diagnoses.of_effects()
    old = found.refined[0]
    moved = replace(old, value=old.nominal * (1 + 0.01 * sigmas), std=1e-3 * old.nominal)
    text = verdict_sentence(replace(found, refined=(moved,)))
    assert text.startswith("A nominal value moved far beyond what is stated: links.rod.mat") is first
    assert (f"({sigmas:+.1f} stated sigma); it was stated wrongly" in text) is first
