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
