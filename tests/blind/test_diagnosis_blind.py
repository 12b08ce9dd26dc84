"""What the diagnosis makes of effects hidden in data from rods: a small sample of benchmarks/blind.py.

Every case is one that an engineer would want right: wrong answers here are defects. How often the diagnosis
is right over many cases is what the benchmark measures.
"""

import pytest
from cases import Case, make_case

import flexarm

pytestmark = pytest.mark.skipif(not hasattr(flexarm, "diagnose"), reason="flexarm.diagnose is not there yet")


def diagnosed(case: Case) -> dict:
    """The report."""
    records = {"train_a": case.train_a, "train_b": case.train_b}
    return flexarm.diagnose(case.model, records, hold_out=case.held_out).to_json_dict()


def sets(report: dict) -> list[set[tuple[str, str]]]:
    """Named effects, each with its alternatives."""
    return [
        {(one["name"], one["at"]) for one in [effect, *effect.get("alternatives", [])]}
        for effect in report["effects"]
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "effect", "at"),
    [
        ("hinged", "joint_hysteresis", "hinge"),
        ("hinged", "backlash", "hinge"),
        ("planar", "joint_compliance", "elbow"),
    ],
)
def test_a_large_effect_in_rich_data_is_named_at_its_place(kind, effect, at):
    """Fifteen times the noise: the name, the place, its parameters within a tenth, and the gap closed."""
    case = make_case(kind, effect, at, 15.0, seed=21)
    report = diagnosed(case)
    assert report["verdict"] == "effects"
    assert [(one["name"], one["at"]) for one in report["effects"]] == [(effect, at)]
    true = case.answer.effects[0].parameters
    leading = report["effects"][0]["parameters"][0]
    assert leading["value"] == pytest.approx(true[leading["name"]], rel=0.1)
    held_out = report["gap"]["held_out"]
    assert held_out["after_rms"] < held_out["noise_rms"] + 0.1 * held_out["before_rms"]


@pytest.mark.slow
def test_in_poor_data_the_truth_is_in_the_set():
    """The tip alone in slow sines, five times the noise: one effect, at most three names for it.

    Refitted through the rods with nuisances, a softer tube is worse by a chi square of 5 and 9 in the two
    records: a Bayes factor near the 20 at which a rival may be left out, so either answer is right.
    """
    report = diagnosed(make_case("hinged", "joint_compliance", "hinge", 5.0, seed=22, rich=False))
    assert len(report["effects"]) == 1
    assert ("joint_compliance", "hinge") in sets(report)[0]
    assert len(sets(report)[0]) <= 3


def test_nothing_is_named_where_nothing_is_hidden():
    report = diagnosed(make_case("hinged", (), (), 0.0, seed=23))
    assert (report["verdict"], report["effects"]) == ("adequate", [])


@pytest.mark.slow
def test_what_has_no_name_is_said_to_be_unexplained():
    """A tracker whose stand sways at 0.7 Hz."""
    assert (
        diagnosed(make_case("hinged", "swaying_tracker", "base", 20.0, seed=24))["verdict"] == "unexplained"
    )


@pytest.mark.slow
def test_two_effects_are_both_found():
    pair = {("coulomb_friction", "hinge"), ("payload_mass", "load")}
    case = make_case("hinged", ("coulomb_friction", "payload_mass"), ("hinge", "load"), 20.0, seed=25)
    found = sets(diagnosed(case))
    assert all(any(one in alternatives for alternatives in found) for one in pair)


def test_a_flipped_channel_is_unusable():
    report = diagnosed(make_case("hinged", "sign_error", "base", 0.0, seed=26))
    assert report["verdict"] == "unusable"
    assert ("sign_error", "tip") in set().union(*sets(report))
