"""When an effect is taken, and how sure a name is."""

from math import log
from types import SimpleNamespace

import pytest

from flexarm.diagnosis import acceptance
from flexarm.diagnosis.acceptance import Criteria
from flexarm.diagnosis.alternatives import probabilities
from flexarm.diagnosis.candidate import Candidate
from flexarm.diagnosis.nuisance import NuisanceParameter
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.effects import TimeDelay

OBSERVED = SimpleNamespace(policy=SelectionPolicy())
"""As much of a problem as is asked for."""
NO_JOINTS = SimpleNamespace(arm=SimpleNamespace(joints=(), closures=(), sensors=(), encoders={}))


@pytest.mark.parametrize(
    ("strained", "gain", "taken"),
    [(0.5, 5.0, False), (0.5, 7.0, True), (1.5, 1.0, False), (1.5, 2.0, True), (1.5, 7.0, True)],
)
def test_an_effect_that_spares_a_strain_needs_odds_of_five_others_of_four_hundred(
    monkeypatch, strained, gain, taken
):
    """It leaves no gap, and explains what matters."""
    new, old = SimpleNamespace(strain=0.0, projected=None), SimpleNamespace(strain=strained)
    monkeypatch.setattr(acceptance, "conflict", lambda fit, policy: fit.strain)
    monkeypatch.setattr(Criteria, "significant", lambda *_: True)
    monkeypatch.setattr(Criteria, "as_stated", lambda *_: False)
    monkeypatch.setattr(Criteria, "leaves_gap", lambda *_: False)
    monkeypatch.setattr(acceptance, "log_bayes_factor", lambda *_: gain)
    assert Criteria(OBSERVED, old).accepts(new, old) is taken


@pytest.mark.parametrize(
    ("cost", "strained", "taken"), [(98.0, 0.0, False), (96.0, 0.0, True), (98.0, 1.5, True)]
)
def test_an_effect_beside_a_gap_takes_a_part_of_it_or_spares_a_strain(monkeypatch, cost, strained, taken):
    """However strong the evidence: a law that nobody knows is mimicked a little by many."""
    new, old = (
        SimpleNamespace(strain=x, cost=c, projected=None) for x, c in ((0.0, cost), (strained, 100.0))
    )
    monkeypatch.setattr(acceptance, "conflict", lambda fit, policy: fit.strain)
    monkeypatch.setattr(Criteria, "significant", lambda *_: True)
    monkeypatch.setattr(Criteria, "as_stated", lambda *_: False)
    monkeypatch.setattr(Criteria, "leaves_gap", lambda *_: True)
    monkeypatch.setattr(acceptance, "log_bayes_factor", lambda *_: 1e3)
    monkeypatch.setattr(acceptance, "press_rms", lambda fit, problem: fit.cost)
    assert Criteria(OBSERVED, old).accepts(new, old) is taken


def left_with(gap, strained, rows):
    """A fit that leaves so large a squared gap, and white noise of so many rows."""
    return SimpleNamespace(cost=gap + rows, strain=strained, residual=range(rows))


@pytest.mark.parametrize(
    ("cost", "strained", "gap", "far"),
    [
        (51, 5.1, False, True),
        (49, 9, False, False),
        (99, 4.9, False, False),
        (51, 0, True, True),
        (49, 0, True, False),
    ],
)
def test_a_model_is_far_off_that_leaves_most_of_the_gap_or_where_none_is_left_of_the_strain(
    monkeypatch, cost, strained, gap, far
):
    """The gap was 100, unknowns were 10 sigmas off; beside an open gap it does not help that they are not."""
    monkeypatch.setattr(acceptance, "conflict", lambda fit, policy: fit.strain)
    monkeypatch.setattr(Criteria, "leaves_gap", lambda *_: gap)
    for rows in (0, 1000):  # noise of more of them is no gap
        fit, null = (left_with(c, s, rows) for c, s in ((cost, strained), (100, 10)))
        assert Criteria(OBSERVED, null).leaves_most(fit) is far


@pytest.mark.parametrize(
    ("cost", "strained", "before", "hardly"),
    [(86, 9, 10, True), (84, 9, 10, False), (99, 8, 10, False), (99, 0, 0, True), (99, 0.9, 0.9, True)],
)
def test_an_effect_hardly_helps_that_takes_little_of_gap_and_strain(
    monkeypatch, cost, strained, before, hardly
):
    """The gap was 100; what is no strain to begin with is none to be spared."""
    monkeypatch.setattr(acceptance, "conflict", lambda fit, policy: fit.strain)
    for rows in (0, 1000):  # noise of more of them is no gap
        fit, null = (left_with(c, s, rows) for c, s in ((cost, strained), (100, before)))
        assert Criteria(OBSERVED, null).hardly_helps(fit) is hardly


def test_what_is_quieter_than_its_noise_has_no_gap_that_anything_could_leave():
    quiet = SimpleNamespace(cost=40.0, residual=range(100))
    assert acceptance.beyond_noise(quiet) == 0.0


def test_no_effect_at_all_takes_part_in_the_odds():
    """Two names alike and odds of two over nothing: 2/5 each; strong evidence leaves nothing no part."""
    alternatives = [SimpleNamespace(behind=0.0)]
    assert probabilities(alternatives, log(2.0)) == pytest.approx([0.4, 0.4])
    assert probabilities(alternatives, 1e5) == pytest.approx([0.5, 0.5])
    assert probabilities([], log(4.0)) == pytest.approx([0.8])


@pytest.mark.parametrize(("delay", "stated"), [(3e-3, True), (5e-3, False)])
def test_a_clock_within_what_is_stated_of_it_is_no_effect(delay, stated):
    """Two milliseconds are stated, and up to two of these the model without the effect has it there too."""
    clock = NuisanceParameter("effects.time_delay.tracker.delay", 0.0, 2e-3, "s", "clock")
    effect = TimeDelay(at="tracker", delay=delay)
    late = Candidate(effect, ("delay",), (), {})
    old = SimpleNamespace(nuisance=SimpleNamespace(parameters=(clock,)), places=())
    new = SimpleNamespace(members=(late,), nuisance=NO_JOINTS)
    assert Criteria(OBSERVED, None).as_stated(new, old) is stated
    assert not Criteria(OBSERVED, None).as_stated(SimpleNamespace(members=()), old)


@pytest.mark.parametrize(
    ("plausible", "least", "taken"), [(7.7, 0.4, True), (27.0, 0.4, False), (7.7, 20.0, False)]
)
def test_far_more_plausible_is_what_also_foretells_about_as_well(monkeypatch, plausible, least, taken):
    """Two springs, 7.7, beside thirty times a mass, 31.8, which foretells hardly better: odds of e^0.4."""
    new, old = SimpleNamespace(odd=plausible), SimpleNamespace(odd=31.8)
    monkeypatch.setattr(acceptance, "implausibility", lambda fit: fit.odd)
    monkeypatch.setattr(acceptance, "log_odds_lost", lambda fits, problem: [least, 0.0])
    assert Criteria(OBSERVED, None).far_more_plausible(new, old) is taken
