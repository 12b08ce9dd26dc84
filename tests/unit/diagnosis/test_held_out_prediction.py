"""A verdict does not stand alone beside a held-out record that the model does not predict."""

import json
from dataclasses import replace

import diagnoses
import pytest
from planted import two_joints
from posed import posed, poses

import flexarm
from flexarm.diagnosis.result import HELD_OUT_RATIO, HeldOutGap, adequate_if_predicted
from flexarm.effects import JointCompliance
from flexarm.report.diagnosis import write
from flexarm.report.sentences import unpredicted_sentence


def not_predicted(**changes):
    """A repair that leaves noise of the training, and the whole gap of the record that was held out."""
    before, after = diagnoses.comparisons()
    return diagnoses.of_effects(after={**after, "other": before["other"]}, **changes)


SAID = (
    "The repaired model does not predict the held-out record 'other': 7.92 mm rms are left of 'tip', "
    "112 times the noise; the training is left with 71.5 µm."
)


@pytest.mark.parametrize("make", [diagnoses.of_effects, diagnoses.adequate], ids=["effects", "adequate"])
def test_a_predicted_record_gets_no_remark(make):
    assert unpredicted_sentence(make()) == ""


def test_what_is_left_stands_beside_noise_and_training():
    assert unpredicted_sentence(not_predicted()).startswith(SAID)


@pytest.mark.parametrize(
    ("kind", "why", "said"),
    [
        (
            "extrapolation",
            "hinge goes up to 2.0 rad",
            "what lies beyond the training (hinge goes up to 2.0 rad)",
        ),
        ("interpolation", "", "It lies within what the training covers"),
        ("repetition", "", "the machine was another one then"),
        ("blocks", "", "something happens there and nowhere else"),
    ],
)
def test_what_it_may_mean_depends_on_what_was_held_out(kind, why, said):
    text = unpredicted_sentence(not_predicted(hold_out_kind=kind, hold_out_why=why))
    assert said in text
    assert ("fault" in text) and (("flexarm check" in text) == (kind != "blocks"))


def test_summary_says_it_under_the_verdict_and_once():
    text = " ".join(
        not_predicted(hold_out_kind="extrapolation", hold_out_why="hinge is fast").summary().split()
    )
    assert text.count(SAID) == 1
    assert text.index("Missing from the model") < text.index(SAID) < text.index("140.0 kN m/rad")
    assert text.count("hinge is fast") == 1


def test_report_and_page_say_it_and_so_does_what_is_loaded(tmp_path):
    d = not_predicted()
    write(d, tmp_path)
    told = json.loads((tmp_path / "report.json").read_text())
    assert told["verdict"] == "effects"  # what was held out chooses nothing
    assert told["details"]["remarks"][0].startswith(SAID)
    html = (tmp_path / "report.html").read_text(encoding="utf-8").replace("&#39;", "'")
    assert html.count(SAID) == 1
    assert html.index("<h1>") < html.index(SAID) < html.index("<table>")
    again = flexarm.Diagnosis.load(tmp_path)
    assert again.summary() == d.summary()
    assert again.to_json_dict()["details"] == told["details"]


def test_a_signal_beside_the_main_one_is_told_too():
    """The tip is predicted, the torque of the held-out record is not."""
    before, after = diagnoses.comparisons()
    other = before["other"]
    torque = flexarm.compare(diagnoses.nominal(), diagnoses.record(3, 0.2), step=0.01).signals["tip"]
    odd = {**after["other"].signals, "torque": torque.__class__(**{**vars(torque), "name": "torque"})}
    d = diagnoses.of_effects(after={**after, "other": other.__class__(**{**vars(other), "signals": odd})})
    assert "7.92 mm rms are left of 'torque', 112 times the noise. " in unpredicted_sentence(d)


def test_no_model_is_adequate_that_does_not_predict_another_machine():
    """Poses of the model's own machine are explained; those held out are of one whose shoulder gives way."""
    training = posed(two_joints(), poses(2, 12, 1), 1)
    soft = two_joints().with_effect(JointCompliance(at="shoulder", stiffness=2e4))
    d = flexarm.diagnose(two_joints(), {"yard": training}, posed(soft, poses(2, 10, 2), 2), n_jobs=1)
    assert d.verdict == "unexplained" and not d.effects
    assert "the model is not adequate: of 'tip' in the held-out 'held_out'" in d.remainder
    assert "The model does not predict the held-out record 'held_out': " in d.summary()


def test_a_record_without_noise_is_predicted_up_to_the_error_of_simulations():
    """Nanometres are no gap, though the training is left with less."""
    assert HeldOutGap("other", "tip", "m", 3e-8, None, 1e-9).ratio < HELD_OUT_RATIO
    assert HeldOutGap("other", "tip", "m", 3e-5, None, 1e-9).ratio > HELD_OUT_RATIO


@pytest.mark.parametrize(("swings", "verdict"), [(False, "unexplained"), (True, "adequate")])
def test_a_training_that_is_left_with_as_much_makes_no_model_adequate(swings, verdict):
    """A fit that judged few rows is no excuse; what an arm swung with at the start of its records is one."""
    before, _ = diagnoses.comparisons()
    d = replace(diagnoses.adequate(), after=before)
    found = adequate_if_predicted(d, {}, swings)
    assert found.verdict == verdict
    assert ("'tip' in the held-out 'other' 7.92 mm rms are left, 112 times the noise" in found.remainder) == (
        verdict == "unexplained"
    )


def test_noise_of_drives_counts_as_noise_of_what_is_held_out():
    before, _ = diagnoses.comparisons()
    d = replace(diagnoses.adequate(), after=before)
    assert adequate_if_predicted(d, {"tip": 60.0**2}, False) is d
    assert adequate_if_predicted(d, {"tip": 10.0**2}, False).verdict == "unexplained"
