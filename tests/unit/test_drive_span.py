"""A drive must be known while the other signals of its record tell of a motion."""

import json
from pathlib import Path

import diagnoses
import numpy as np
import pytest

import flexarm
from flexarm.cli.run import run as main
from flexarm.record import Clock, Record, Signal
from flexarm.record.plausibility import unknown_motion

RECORD = diagnoses.record(1)
"""A sine of 12 s that goes on at its end; encoder at 100 Hz, tracker at 10 Hz."""


def cut(keep, record=RECORD, name="hinge"):
    """The record with some rows of a signal, by their times."""
    signal = record.signals[name]
    rows = keep(signal.time)
    shorter = signal.replace(time=signal.time[rows], values=signal.values[rows])
    return record.replace(signals={**record.signals, name: shorter})


def lost(keep, record=RECORD):
    """The record with drop-outs of its drive at the other rows."""
    signal = record.signals["hinge"]
    values = np.where(keep(signal.time)[:, None], signal.values, np.nan)
    return record.replace(signals={**record.signals, "hinge": signal.replace(values=values)})


def at_rest(until=12.0, stands_from=6.0):
    """A swing that stands from an instant on; the log of the drive ends at another one."""
    signal = RECORD.signals["hinge"]
    moved = np.interp(np.minimum(signal.time, stands_from), signal.time, signal.values[:, 0])
    tip = RECORD.signals["tip"]
    places = [np.interp(np.minimum(tip.time, stands_from), tip.time, column) for column in tip.values.T]
    signals = {
        "hinge": signal.replace(values=moved[:, None]),
        "tip": tip.replace(values=np.column_stack(places)),
    }
    return cut(lambda t: t <= until, RECORD.replace(signals=signals))


UNKNOWN = {
    "ends at 1 s, tip is seen from 1.": cut(lambda t: t <= 1.0),
    "ends at 9 s, tip is seen from 9.": cut(lambda t: t <= 9.0),
    "begins at 3 s, tip is seen from 0.": cut(lambda t: t >= 3.0),
    "pauses from 5 to 7 s, tip is seen from 5.": cut(lambda t: (t <= 5.0) | (t >= 7.0)),
}


@pytest.mark.parametrize(("said", "record"), UNKNOWN.items(), ids=["soon", "late", "begin", "pause"])
@pytest.mark.parametrize("command", ["check", "check beside", "compare", "diagnose", "simulate"])
def test_a_drive_that_is_unknown_during_the_motion_is_refused(command, said, record, tmp_path: Path, capsys):
    arm, run, out = tmp_path / "arm.toml", tmp_path / "run", tmp_path / "out"
    diagnoses.nominal().to_toml(arm)
    record.save(run)
    arguments = {
        "check": ["check", run],
        "check beside": ["check", arm, run],
        "compare": ["compare", arm, run],
        "diagnose": ["diagnose", arm, run, "--out", out],
        "simulate": ["simulate", arm, "--drive", run, "--out", out],
    }[command]
    assert main(list(map(str, arguments))) == 2
    error = capsys.readouterr().err.splitlines()[-1]
    assert error.startswith(f"error: {run}") and f"signals.hinge: {said}" in error
    assert "a drive must cover the motion of the other signals" in error
    assert not out.exists()


def test_drop_outs_count_as_a_pause_and_python_refuses_as_commands_do():
    record = lost(lambda t: (t <= 5.0) | (t >= 7.0))
    for judge in (
        lambda: flexarm.compare(diagnoses.nominal(), record),
        lambda: flexarm.diagnose(diagnoses.nominal(), [record]),
        lambda: record.check_against(diagnoses.nominal()),
    ):
        with pytest.raises(flexarm.InvalidParameter, match=r"pauses from 5 to 7 s"):
            judge()


@pytest.mark.parametrize(
    "record",
    [
        RECORD,
        cut(lambda t: t <= 11.9),
        lost(lambda t: (t <= 5.0) | (t >= 5.25)),
        at_rest(until=8.0),
        lost(lambda t: (t <= 7.0) | (t >= 9.0), at_rest()),
    ],
    ids=["whole", "ends a sample of the tracker early", "short pause", "ends at rest", "pauses at rest"],
)
def test_a_drive_that_covers_the_motion_is_taken(record):
    assert unknown_motion(record) == []


def test_a_drive_that_stops_at_rest_before_the_arm_moves_on_is_refused():
    """The swing has hardly begun at 0.2 s."""
    (problem,) = unknown_motion(cut(lambda t: t <= 0.2))
    assert problem.what.startswith("ends at 0.2 s, tip is seen from")


@pytest.mark.parametrize(("last", "refused"), [(12.0, False), (4.0, True)])
def test_of_a_clock_of_unknown_offset_only_durations_count(last, refused):
    clocks = {**RECORD.clocks, "tracker": Clock(unknown=True)}
    record = cut(lambda t: t <= last, RECORD.replace(clocks=clocks))
    problems = unknown_motion(record)
    assert bool(problems) == refused
    assert all("lasts 4 s, tip moves for" in problem.what for problem in problems)


def test_a_drive_may_end_within_the_uncertainty_of_a_clock():
    clocks = {**RECORD.clocks, "tracker": Clock(sigma=1.0)}
    assert unknown_motion(cut(lambda t: t <= 9.5, RECORD.replace(clocks=clocks))) == []


def test_a_drive_of_a_single_value_is_told_of_the_record(tmp_path: Path, capsys):
    arm, run = tmp_path / "arm.toml", tmp_path / "run"
    diagnoses.nominal().to_toml(arm)
    cut(lambda t: t <= 0.0).save(run)
    for arguments in (["check", run], ["check", arm, run], ["diagnose", arm, run, "--out", tmp_path / "o"]):
        assert main(list(map(str, arguments))) == 2
        assert "signals.hinge: drives, and holds a single value" in capsys.readouterr().err.splitlines()[-1]


def test_a_locked_joint_drives():
    signal = RECORD.signals["hinge"]
    locked = signal.replace(values=np.full_like(signal.values, 0.3))
    assert unknown_motion(RECORD.replace(signals={**RECORD.signals, "hinge": locked})) == []


def test_a_record_lasts_as_long_as_its_drive_whatever_other_clocks_count_from(tmp_path: Path, capsys):
    tip = RECORD.signals["tip"]
    late = tip.replace(time=tip.time + 1.7e9)
    clocks = {**RECORD.clocks, "tracker": Clock(unknown=True)}
    record = RECORD.replace(signals={**RECORD.signals, "tip": late}, clocks=clocks)
    assert record.duration == pytest.approx(11.99)
    record.save(tmp_path / "run")
    assert main(["check", str(tmp_path / "run"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["duration"] == pytest.approx(11.99)


def test_stamps_that_count_from_1970_keep_their_digits() -> None:
    """As 1.78e+09 s both would be the same instant."""
    time = 1.78e9 + np.linspace(0.0, 10.0, 1001)
    swing = np.sin(time - 1.78e9)
    drive = Signal(name="hinge", quantity="joint_angle", joint="hinge", time=time[:501], values=swing[:501])
    tip = Signal(name="tip", quantity="position", point="tip", axes=("x",), time=time, values=swing)
    [problem] = unknown_motion(Record(signals=[drive, tip], drive=["hinge"]))
    assert problem.what.startswith("ends at 1780000005 s, tip is seen from 1780000005.26 to 1780000010 s")
