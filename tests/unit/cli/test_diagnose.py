"""The command `flexarm diagnose`, with a diagnosis that is known: what it hands on, writes, and refuses."""

import json
import signal
import subprocess
import sys
import time

import diagnoses
import pytest

import flexarm
from flexarm.cli.run import run
from flexarm.input_files import sha256


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    """A model and three records as files."""
    directory = tmp_path_factory.mktemp("bench")
    diagnoses.nominal().to_toml(directory / "arm.toml")
    for seed, name in enumerate(("slow", "fast", "other"), 1):
        diagnoses.record(seed).save(directory / name)
    return directory


@pytest.fixture
def calls(monkeypatch):
    """Stands in for the diagnosis; keeps what it was called with."""
    seen = []

    def diagnose(arm, records, **options):
        seen.append((arm, records, options))
        return diagnoses.unusable()

    monkeypatch.setattr(flexarm, "diagnose", diagnose, raising=False)
    return seen


def command(bench, out, *more, hold_out="other"):
    held = ["--hold-out", str(bench / hold_out)] if hold_out else []
    return [
        "diagnose",
        str(bench / "arm.toml"),
        str(bench / "slow"),
        str(bench / "fast"),
        *held,
        "--out",
        str(out),
        *more,
    ]


def test_records_seed_and_jobs_reach_the_library(bench, tmp_path, calls):
    assert run(command(bench, tmp_path / "out", "--jobs", "2", "--seed", "7")) == 0
    [(arm, records, options)] = calls
    assert arm == diagnoses.nominal()
    assert list(records) == ["slow", "fast"]
    assert all(isinstance(record, flexarm.Record) for record in records.values())
    assert isinstance(options["hold_out"], flexarm.Record)
    assert (options["n_jobs"], options["seed"]) == (2, 7)


def test_without_a_hold_out_there_is_none(bench, tmp_path, calls):
    assert run(command(bench, tmp_path / "out", hold_out=None)) == 0
    assert calls[0][2]["hold_out"] is None


def test_verdict_is_printed_with_the_place_of_the_page(bench, tmp_path, calls, capsys):
    assert run(command(bench, tmp_path / "out")) == 0
    told = capsys.readouterr()
    assert told.err == ""
    assert "sign error at signal tip" in told.out
    assert told.out.endswith(f"open {tmp_path / 'out' / 'report.html'}\n")
    assert {"report.html", "report.json", "updated.toml"} <= {p.name for p in (tmp_path / "out").iterdir()}


def test_report_traces_every_input_by_its_hash(bench, tmp_path, calls):
    run(command(bench, tmp_path / "out"))
    provenance = json.loads((tmp_path / "out" / "report.json").read_text())["provenance"]
    files = provenance["inputs_sha256"]
    assert files["arm.toml"] == sha256(bench / "arm.toml")
    for record in ("slow", "fast", "other"):
        assert {f"{record}/{path.name}" for path in (bench / record).iterdir()} <= set(files)
    assert provenance["seed"] == 3  # what else the library says of itself stays


def test_records_of_one_name_are_told_apart_by_their_parents(bench, tmp_path, calls):
    for day in ("monday", "friday"):
        diagnoses.record(1).save(tmp_path / day / "slow")
    records = [str(tmp_path / day / "slow") for day in ("monday", "friday")]
    assert run(["diagnose", str(bench / "arm.toml"), *records, "--out", str(tmp_path / "out")]) == 0
    assert list(calls[0][1]) == ["monday/slow", "friday/slow"]


# ---------------------------------------------------------------------------- refusals


def refused(arguments, capsys):
    code = run(arguments)
    told = capsys.readouterr()
    assert told.out == ""
    return code, told.err


@pytest.mark.parametrize("twice", ["slow", "slow/record.toml", "../BENCH/slow"])
def test_a_record_held_out_must_not_be_trained_on(twice, bench, tmp_path, calls, capsys):
    twice = twice.replace("BENCH", bench.name)
    code, err = refused(command(bench, tmp_path / "out", hold_out=twice), capsys)
    assert code == 2
    assert err.startswith(f"error: {bench / twice}: RECORD: is given twice")
    assert calls == []
    assert list(tmp_path.iterdir()) == []


def test_an_occupied_directory_is_refused_before_the_work(bench, tmp_path, calls, capsys):
    (tmp_path / "mine.txt").write_text("mine")
    code, err = refused(command(bench, tmp_path), capsys)
    assert code == 2
    assert "holds files already" in err
    assert calls == []
    assert run(command(bench, tmp_path, "--force")) == 0
    assert (tmp_path / "mine.txt").read_text() == "mine"


def test_a_missing_record_is_named(bench, tmp_path, calls, capsys):
    code, err = refused(command(bench, tmp_path / "out", hold_out="nowhere"), capsys)
    assert (code, calls) == (2, [])
    assert err.startswith(f"error: {bench / 'nowhere'}: ")


def test_a_record_of_another_arm_is_named_with_its_place(bench, tmp_path, calls, capsys):
    strange = tmp_path / "strange"
    diagnoses.record(1).save(strange)
    text = (strange / "record.toml").read_text()
    (strange / "record.toml").write_text(text.replace('point = "tip"', 'point = "nose"'))
    arguments = ["diagnose", str(bench / "arm.toml"), str(strange), "--out", str(tmp_path / "out")]
    code, err = refused(arguments, capsys)
    assert (code, calls) == (2, [])
    assert err.startswith(f"error: {strange / 'record.toml'}: signals.tip.point: ")
    assert "'nose'" in err


@pytest.mark.parametrize(
    ("option", "value"), [("--jobs", "0"), ("--jobs", "two"), ("--seed", "-1"), ("--sead", "1")]
)
def test_a_wrong_option_is_told(option, value, bench, tmp_path, calls, capsys):
    code, err = refused(command(bench, tmp_path / "out", option, value), capsys)
    assert code == 2
    assert option in err
    assert err.startswith("error: command line: ")
    assert not (tmp_path / "out").exists()


def test_a_failure_of_the_numbers_is_code_3_and_leaves_nothing(bench, tmp_path, monkeypatch, capsys):
    def fail(*given, **options):
        raise flexarm.NotConverged("no equilibrium", time=1.5, iteration=25, residual=3.2)

    monkeypatch.setattr(flexarm, "diagnose", fail, raising=False)
    code, err = refused(command(bench, tmp_path / "out"), capsys)
    assert code == 3
    assert err == "error: no equilibrium (time = 1.5 s, iteration = 25, residual = 3.2)\n"
    assert list(tmp_path.iterdir()) == []


def test_an_error_about_a_record_names_its_file(bench, tmp_path, monkeypatch, capsys):
    """The library does not know from which file a record came; the first one that fails alone is it."""

    def fail(*given, **options):
        raise flexarm.InvalidParameter("signal 'hinge' cannot drive", where="drive")

    driven = tmp_path / "driven"
    diagnoses.record(1).save(driven)
    text = (driven / "record.toml").read_text()
    text = text.replace('"joint_angle"', '"motor_torque"').replace('unit = "rad"', 'unit = "N m"')
    (driven / "record.toml").write_text(text)
    monkeypatch.setattr(flexarm, "diagnose", fail, raising=False)
    arguments = [
        "diagnose",
        str(bench / "arm.toml"),
        str(bench / "slow"),
        str(driven),
        "--out",
        str(tmp_path / "out"),
    ]
    code, err = refused(arguments, capsys)
    assert code == 2
    assert err.splitlines()[-1].startswith(f"error: {driven}: drive: ")


def test_ctrl_c_is_told_and_leaves_nothing_behind(bench, tmp_path):
    """As a person would: a real diagnosis that is told to stop in the middle of the work."""
    program = "from flexarm.cli import main; main()"
    words = [sys.executable, "-c", program, *command(bench, tmp_path / "out", "--jobs", "1")]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    until = time.monotonic() + 30
    while not list(tmp_path.glob(".out.partial")) and time.monotonic() < until:
        time.sleep(0.02)
    time.sleep(0.5)  # into the diagnosis
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=30) == ("", "interrupted: nothing was written\n")
    assert process.returncode == 128 + signal.SIGINT
    assert list(tmp_path.iterdir()) == []


def test_help_teaches_with_an_example(capsys):
    assert run(["diagnose", "--help"]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "flexarm diagnose arm.toml slow fast --hold-out other_day --out diagnosis" in told
    assert "flexarm compare diagnosis/updated.toml other_day" in told
    assert "Ctrl-C stops it with exit code 130, and nothing is written" in told


def test_progress_is_told_with_what_is_being_done(bench, tmp_path, monkeypatch, capsys):
    def diagnose(arm, records, *, progress, **options):
        progress(0.25, "screen")
        progress(1.0, "report")
        return diagnoses.unusable()

    monkeypatch.setattr(flexarm, "diagnose", diagnose, raising=False)
    monkeypatch.setattr("flexarm.cli.progress.SECONDS", 0.0)
    assert run(command(bench, tmp_path / "out")) == 0
    told = capsys.readouterr()
    assert told.err.splitlines()[0] == "screen: 25 %, 0 s"
    assert "screen" not in told.out
