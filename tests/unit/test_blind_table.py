"""The blind test's table from made-up reports: every row counts what it says."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "benchmarks"))

from blind_plan import COUNTS, planned  # noqa: E402
from blind_table import Outcome, closure, f1, harmless, tabulated, wilson  # noqa: E402

NOISE = 4e-5


def hidden(name: str = "backlash", at: str = "elbow", size: float = 10.0, **parameters: float) -> dict:
    return {"name": name, "at": at, "at_any": [at], "parameters": parameters, "size": size}


def named(
    name: str = "backlash", at: str = "elbow", probability: float = 0.9, *rivals: tuple, **more: tuple
) -> dict:
    """An effect of a report; further arguments are parameters with low, high."""
    parameters = [{"name": key, "low90": low, "high90": high} for key, (low, high) in more.items()]
    alternatives = [{"name": rival, "at": place, "probability": 0.1} for rival, place in rivals]
    about = {"name": name, "at": at, "probability": probability}
    return about | {"parameters": parameters, "alternatives": alternatives}


def outcome(
    effects: list, report: list, group: str = "single", verdict: str = "effects", **more: object
) -> Outcome:
    right = {"none": ["adequate"], "outside": ["unexplained"], "fault": ["unusable", "effects"]}
    answer = {"group": group, "kind": "planar", "effects": effects, "noise": NOISE}
    answer["verdict"] = right.get(group, ["effects"])
    return Outcome(
        answer, {"verdict": verdict, "effects": report}, **{"before": 1e-3, "after": NOISE, **more}
    )


def rate(title: str, *outcomes: Outcome) -> tuple[int, int]:
    """k and n of the row whose title begins so."""
    row = next(row for row in tabulated(outcomes).rates if row.title.strip().startswith(title))
    return row.k, row.n


def test_wilson_intervals_are_wilsons():
    """8 of 10: 0.490 to 0.943; 0 of 10: 0 to 0.278 (Newcombe's tables)."""
    assert wilson(8, 10) == pytest.approx((0.4902, 0.9433), abs=1e-4)
    assert wilson(0, 10) == pytest.approx((0.0, 0.2775), abs=1e-4)
    assert wilson(0, 0) == (0.0, 1.0)


def test_a_right_name_at_the_wrong_joint_has_not_the_right_place():
    cases = [outcome([hidden()], [named()]), outcome([hidden()], [named(at="shoulder")])]
    assert rate("right name, single", *cases) == (2, 2)
    assert rate("right name and place", *cases) == (1, 2)


def test_a_second_name_makes_the_first_wrong():
    both = outcome([hidden()], [named(), named("link_mass", "forearm")])
    assert rate("right name, single", both) == (0, 1)


def test_small_effects_count_for_the_power_curve_alone():
    small = outcome([hidden(size=3.0)], [named()])
    large = outcome([hidden(size=30.0)], [], group="power")
    table = tabulated([small, large])
    counts = {row.title.strip(): (row.k, row.n) for row in table.rates}
    assert "right name, single, >= 10 x floor, rich" not in counts
    assert counts["power: right name at about 3 x floor"] == (1, 1)
    assert counts["power: right name at about 30 x floor"] == (0, 1)


def test_the_truth_may_be_an_alternative():
    """In the set, not on top; a confident name with it in the set is not counted as wrong."""
    poor = outcome([hidden()], [named("link_mass", "forearm", 0.9, ("backlash", "elbow"))], group="poor")
    assert rate("truth in the set, poor", poor) == (1, 1)
    assert rate("wrong and confident", poor) == (0, 1)
    assert next(n.value for n in tabulated([poor]).numbers if n.title.startswith("names in the set")) == 2.0


@pytest.mark.parametrize(("probability", "wrong"), [(0.9, 1), (0.7, 0)])
def test_wrong_and_confident_needs_both(probability, wrong):
    case = outcome([hidden()], [named("link_mass", "forearm", probability)], verdict="unexplained")
    assert rate("wrong and confident", case) == (wrong, 1)


def test_a_part_of_what_has_no_name_is_no_wrong_claim_if_the_rest_is_said():
    said, unsaid = (outcome([], [named()], group="outside", verdict=v) for v in ("unexplained", "effects"))
    assert rate("wrong and confident", said, unsaid) == (1, 2)


def test_any_name_is_a_false_alarm_where_nothing_is_hidden():
    quiet = outcome([], [], group="none", verdict="adequate")
    loud = outcome([], [named(probability=0.3)], group="none")
    assert rate("an effect named where there is none", quiet, loud) == (1, 2)


def test_outside_the_vocabulary_unexplained_is_right_even_with_a_part_named():
    partly = outcome([], [named()], group="outside", verdict="unexplained")
    assert rate("outside the vocabulary", partly, outcome([], [], group="outside", verdict="adequate")) == (
        1,
        2,
    )


def test_f1_of_one_found_of_two_and_one_wrong_is_a_half():
    pair = [hidden(), hidden("link_mass", "forearm")]
    assert f1(outcome(pair, [named(), named("base_tilt", "base")], group="double")) == 0.5
    assert f1(outcome(pair, [named()], group="double")) == pytest.approx(2 / 3)
    assert f1(outcome(pair, [named("link_mass", "forearm"), named()], group="double")) == 1.0


def test_intervals_count_for_rightly_named_effects():
    """A phase may be off by full turns; multiples are not checked; nor is what sits at another place."""
    truth = hidden("transmission_error", "elbow", amplitude=1e-4, multiple=2.0, phase=3.0)
    right = named(
        "transmission_error", "elbow", amplitude=(0.9e-4, 1.05e-4), multiple=(0, 1), phase=(-3.4, -3.2)
    )
    wrong = named("transmission_error", "shoulder", amplitude=(2e-4, 3e-4))
    table = tabulated([outcome([truth], [right]), outcome([truth], [wrong])])
    assert table.coverage == {"transmission_error.amplitude": (1, 1), "transmission_error.phase": (1, 1)}


def test_closure_goes_from_the_gap_before_to_the_noise():
    half = outcome([hidden()], [named()], after=(1e-3 + NOISE) / 2)
    assert closure(half) == pytest.approx(0.5)
    assert closure(outcome([hidden()], [named()])) == 1.0
    assert closure(outcome([hidden()], [], after=float("nan"))) == 0.0


def test_harm_is_more_than_one_percent():
    assert harmless(outcome([], [], after=1.009e-3))
    assert not harmless(outcome([], [], after=1.02e-3))


def test_outliers_may_be_removed_and_said():
    spiky = hidden("outliers", "tip")
    removed = outcome([spiky], [], group="fault", verdict="adequate")
    dead = outcome([hidden("dead_channel", "tip")], [], group="fault", verdict="adequate")
    flipped = outcome(
        [hidden("sign_error", "tip")], [named("sign_error", "tip")], group="fault", verdict="unusable"
    )
    assert rate("sensor at fault", removed, dead, flipped) == (2, 3)


def test_a_case_that_failed_is_counted_and_said():
    failed = outcome([hidden()], [], error="NotConverged: step 3", after=float("nan"))
    table = tabulated([failed, outcome([hidden()], [named()])])
    assert rate("right name, single", failed, outcome([hidden()], [named()])) == (1, 2)
    assert "NotConverged" in table.confusion[0]
    assert table.confusion[1].startswith("ok")
    assert "held-out gap closed" in str(table)


@pytest.mark.parametrize("group", COUNTS)
def test_a_seed_gives_one_plan(group):
    """And another seed another one; the first of a longer plan are those of a shorter one."""
    plan = planned(group, 8, 3)
    assert len({spec.name for spec in plan}) == 8
    assert planned(group, 8, 3)[:5] == planned(group, 5, 3)
    assert planned(group, 8, 4) != plan


def test_singles_take_every_effect_in_turn():
    from hidden_effects import HIDDEN

    assert {spec.effects[0] for spec in planned("single", len(HIDDEN), 1)} == set(HIDDEN)
