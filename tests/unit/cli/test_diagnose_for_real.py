"""`flexarm diagnose` from files to files: the hidden spring is found, the gaps are those of compare."""

import json

import diagnoses
import pytest
from pytest import approx

from flexarm.cli.run import run


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    """A model without a spring, records of a machine that has one, and what the command made of them."""
    directory = tmp_path_factory.mktemp("bench")
    diagnoses.nominal().to_toml(directory / "arm.toml")
    for (seed, rate), name in zip(((1, 0.15), (2, 0.25), (3, 0.2)), ("slow", "fast", "other"), strict=True):
        diagnoses.record(seed, rate, step=2e-3).save(directory / name)
    training = [str(directory / name) for name in ("slow", "fast")]
    command = ["diagnose", str(directory / "arm.toml"), *training, "--hold-out", str(directory / "other")]
    assert run([*command, "--out", str(directory / "out")]) == 0
    return directory


@pytest.fixture(scope="module")
def report(bench):
    return json.loads((bench / "out" / "report.json").read_text())


def test_the_hidden_spring_is_in_the_set(report):
    [effect] = report["effects"]
    named = {(effect["name"], effect["at"]), *((a["name"], a["at"]) for a in effect["alternatives"])}
    assert report["verdict"] == "effects"
    assert ("joint_compliance", "hinge") in named


def test_reported_gaps_are_what_compare_prints(bench, report, capsys):
    """On the record alone: clocks and frames aligned within their sigmas, nothing else fitted."""
    for model, key in (("arm.toml", "before_rms"), ("out/updated.toml", "after_rms")):
        assert run(["compare", str(bench / model), str(bench / "other"), "--json"]) == 0
        printed = json.loads(capsys.readouterr().out)["signals"][report["gap"]["signal"]]
        assert report["gap"]["held_out"][key] == approx(printed["rms"]["total"], rel=1e-6)


def test_the_repair_holds_on_what_was_held_out(report):
    gap = report["gap"]["held_out"]
    assert gap["after_rms"] < 0.02 * gap["before_rms"]


def test_every_file_of_the_report_is_there(bench, report):
    there = {path.name for path in (bench / "out").iterdir()}
    named = {name for effect in report["effects"] for name in effect["figures"]}
    assert {"report.html", "updated.toml", *named} <= there
    assert report["provenance"]["seconds"] > 0
    assert report["provenance"]["version"]
