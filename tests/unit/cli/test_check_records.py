"""`flexarm check MODEL RECORD...`: the sensors of records beside a model, before a diagnosis."""

import json

import diagnoses
import numpy as np
import pytest

from flexarm.cli.run import run


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    """A model, a record of a machine with a spring that the model lacks, and one with tip x turned over."""
    directory = tmp_path_factory.mktemp("bench")
    diagnoses.nominal().to_toml(directory / "arm.toml")
    right = diagnoses.record(1)
    right.save(directory / "right")
    tip = right.signals["tip"]
    turned = tip.replace(values=tip.values * np.array([-1.0, 1.0]))
    right.replace(signals={**right.signals, "tip": turned}).save(directory / "turned")
    return directory


def test_a_record_that_only_lacks_physics_is_usable(bench, capsys):
    assert run(["check", str(bench / "arm.toml"), str(bench / "right")]) == 0
    out = capsys.readouterr().out
    assert "no sensor is at fault" in out
    assert "flexarm compare" in out


def test_a_channel_that_is_turned_over_is_named(bench, capsys):
    assert run(["check", str(bench / "arm.toml"), str(bench / "turned"), "--json"]) == 2
    told = json.loads(capsys.readouterr().out)
    assert not told["usable"]
    [problem] = told["problems"]
    assert problem["where"] == "signals.tip" and "tip x moves against the model" in problem["what"]
    [fault] = told["faults"]
    assert (fault["name"], fault["at"], fault["channels"]) == ("sign_error", "tip", ["x"])
    assert fault["records"] == ["turned"]


def far_away(bench):
    """A tip 2 km from the base of an arm of 3 m, that moves as it should."""
    record = diagnoses.record(1)
    tip = record.signals["tip"]
    far = tip.replace(values=tip.values + 2e3)
    record.replace(signals={**record.signals, "tip": far}).save(bench / "far", force=True)
    return bench / "far"


def test_no_sensor_is_called_in_order_beside_a_warning_that_its_values_cannot_be(bench, capsys):
    assert run(["check", str(bench / "arm.toml"), str(far_away(bench))]) == 0  # a warning, no fault
    out, err = capsys.readouterr()
    assert "signals.tip: reaches 200" in err
    assert "no sensor is at fault" not in out
    assert out.startswith(
        "1 record checked: sensors cannot be judged with this model until what is doubted is"
    )
    assert "doubt: far: signals.tip: reaches 200" in out
    assert "flexarm compare" not in out


def test_doubts_are_told_to_programs(bench, capsys):
    assert run(["check", str(bench / "arm.toml"), str(far_away(bench)), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert all(doubt.startswith("far: signals.tip: reaches 200") for doubt in told["doubts"])
    assert (told["usable"], bool(told["doubts"])) == (True, True)
    assert run(["check", str(bench / "arm.toml"), str(bench / "right"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["doubts"] == []


def test_beside_an_arm_of_kilometres_no_sensor_is_judged(bench, capsys):
    """Its rod is 3 km long, as in millimetres; nor can it be simulated, which is said as well."""
    text = (bench / "arm.toml").read_text().replace("3.0]", "3000.0]")
    (bench / "km.toml").write_text(text)
    assert run(["check", str(bench / "km.toml"), str(bench / "right")]) == 0
    out = capsys.readouterr().out
    assert "no sensor is at fault" not in out
    assert "doubt: model: links.rod.end: is 3000 m away" in out


def test_what_is_merely_not_stated_is_no_doubt(bench, capsys):
    """Without a noise there is a warning, and the sensors are judged as ever."""
    record = diagnoses.record(1)
    tip = record.signals["tip"].replace(noise_std=None)
    record.replace(signals={**record.signals, "tip": tip}).save(bench / "silent")
    assert run(["check", str(bench / "arm.toml"), str(bench / "silent")]) == 0
    out, err = capsys.readouterr()
    assert "noise_std: is not given" in err
    assert "no sensor is at fault" in out


def test_a_fault_is_told_before_any_doubt(bench, capsys):
    """A tip in millimetres is beyond reach and moves a thousand times too far: that says it all."""
    record = diagnoses.record(1)
    tip = record.signals["tip"]
    large = tip.replace(values=1e3 * tip.values)
    record.replace(signals={**record.signals, "tip": large}).save(bench / "large")
    assert run(["check", str(bench / "arm.toml"), str(bench / "large")]) == 2
    out = capsys.readouterr().out
    assert out.startswith("1 record checked: data are unusable\n  unit_error")
    assert "doubt" not in out


def test_several_records_are_checked_together(bench, capsys):
    command = ["check", str(bench / "arm.toml"), str(bench / "right"), str(bench / "turned")]
    assert run(command) == 2
    out, err = capsys.readouterr()
    assert out.startswith("2 records checked: data are unusable")
    assert "in turned" in out
    last = err.splitlines()[-1]
    assert last.startswith(f"error: {bench / 'turned'}: signals.tip: sign_error: ")


def test_clocks_that_never_meet_are_said_and_no_sensor_is_judged(bench, capsys):
    """Beside an arm that stands at its last angle every row looks odd; that is not the sensor's fault."""
    record = diagnoses.record(1)
    tip = record.signals["tip"]
    late = record.replace(signals={**record.signals, "tip": tip.replace(time=tip.time + 1e3)})
    late.save(bench / "late")
    assert run(["check", str(bench / "arm.toml"), str(bench / "late")]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    last = err.splitlines()[-1]
    assert last.startswith(f"error: {bench / 'late'}: signals.tip: runs from 1000")
    assert "no instant in common" in last


def test_only_a_model_has_records_beside_it(bench, capsys):
    assert run(["check", str(bench / "right"), str(bench / "turned")]) == 2
    assert "PATH: is no model" in capsys.readouterr().err


def test_what_is_uncertain_is_shown(bench, capsys):
    assert run(["check", str(bench / "arm.toml")]) == 0
    out = capsys.readouterr().out
    assert "links.rod.material.youngs_modulus +- 1 % (1 sigma)" in out
    assert "points.tip.position +- 0.0005 m (1 sigma)" in out
    assert run(["check", str(bench / "arm.toml"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["uncertainty"] == {"links.rod.material.youngs_modulus": 0.01, "points.tip.position_m": 5e-4}
