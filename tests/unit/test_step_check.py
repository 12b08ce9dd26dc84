"""The time step of `compare` and `diagnose`: an option, and a warning where half of it moves predictions."""

import json
import re

import diagnoses
import numpy as np
import pytest
from arms import beam, hinge, point

import flexarm
from flexarm.cli.run import run
from flexarm.comparison import compare

NOTE = re.compile(
    r"(\w+): half the time step of (\S+) ms moves the prediction by (\S+) times the noise; "
    r"take a step of (\S+) ms or less \(--step\)"
)


@pytest.fixture(scope="module")
def exact():
    """A swing of which the tracker is said to see every tenth of a micrometre."""
    swing = diagnoses.record(1, 0.25)
    tip = swing.signals["tip"].replace(noise_std=1e-7)
    return swing.replace(signals={**swing.signals, "tip": tip})


def told(record, step):
    notes = compare(diagnoses.with_spring(), record, step=step, check_step=True).notes
    return [found.groups() for note in notes if (found := NOTE.match(note))]


def test_a_coarse_step_is_told_with_the_step_that_is_fine_enough(exact):
    [(signal, stated, times, wanted)] = told(exact, 0.01)
    assert (signal, stated) == ("tip", "10") and float(times) > 0.5
    assert float(wanted) == pytest.approx(10 * np.sqrt(0.5 / float(times)), rel=0.1)  # order two
    assert told(exact, 1e-3 * float(wanted)) == []


def test_the_step_that_controllers_leave_is_halved():
    """Controllers that sample every 4 ms leave no step of 20 ms: half of 4 ms is tried."""
    arm = flexarm.Arm.from_dict(
        {
            "joints": [hinge("hinge", "rod")],
            "links": [beam("rod", [0, 0, 1.0], {"shape": "round", "diameter": 0.05})],
            "points": [point("tip", "rod", [0, 0, 1.0])],
            "controllers": [
                {
                    "type": "cascade",
                    "joint": "hinge",
                    "position_gain": 10.0,
                    "velocity_gain": 50.0,
                    "sample_time": 4e-3,
                }
            ],
        }
    )
    t = np.linspace(0, 1, 101)
    told_to = flexarm.Signal(
        name="command",
        quantity="joint_command",
        joint="hinge",
        time=t,
        values=0.1 * np.sin(4 * t)[:, None] ** 2,
    )
    tip = flexarm.Signal(
        name="tip", quantity="position", point="tip", time=t, values=np.zeros((101, 3)), noise_std=1e-9
    )
    record = flexarm.Record(signals=[told_to, tip], drive=("command",))
    notes = compare(arm, record, step=0.02, align=False, check_step=True).notes
    assert any("half the time step of 4 ms moves the prediction" in note for note in notes), notes


def test_no_run_is_added_unless_it_is_asked_for(exact):
    assert not any(NOTE.match(note) for note in compare(diagnoses.with_spring(), exact, step=0.01).notes)


def test_compare_takes_a_step_and_warns(exact, tmp_path, capsys):
    diagnoses.with_spring().to_toml(tmp_path / "arm.toml")
    exact.save(tmp_path / "run")
    command = ["compare", str(tmp_path / "arm.toml"), str(tmp_path / "run"), "--step"]
    assert run([*command, "0.01"]) == 0
    assert "half the time step of 10 ms" in " ".join(capsys.readouterr().out.split())
    assert run([*command, "0"]) == 2
    assert "--step: must be positive and at most 1e+11 s, got 0 s" in capsys.readouterr().err


def test_a_diagnosis_takes_a_finer_step_where_it_must_and_writes_it(exact, tmp_path):
    diagnoses.with_spring().to_toml(tmp_path / "arm.toml")
    exact.save(tmp_path / "run")
    out = tmp_path / "out"
    command = [
        "diagnose",
        str(tmp_path / "arm.toml"),
        str(tmp_path / "run"),
        "--out",
        str(out),
        "--step",
        "0.02",
    ]
    assert run(command) == 0
    report = json.loads((out / "report.json").read_text())
    assert report["provenance"]["step"] == 0.005
    said = "simulated in steps of 5 ms: those of 20 ms miss more than the noise"
    assert said in report["details"]["remarks"]
    assert flexarm.Diagnosis.load(out).provenance["step"] == 0.005
