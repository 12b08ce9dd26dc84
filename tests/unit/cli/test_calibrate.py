"""The command `flexarm calibrate` on a small virtual machine: files, text, JSON and refusals."""

import json
import re

import numpy as np
import pytest

import flexarm
from flexarm import Arm, Record, Signal
from flexarm.cli.run import run
from flexarm.comparison.poses import solve_poses
from flexarm.effects.joint_compliance import JointCompliance


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    """A pendulum in the vertical plane whose joint is soft, as files: model, record and another record."""
    directory = tmp_path_factory.mktemp("bench")
    arm = Arm.from_dict(
        {
            "format": "flexarm-arm/1",
            "joints": [
                {"name": "hinge", "type": "revolute", "parent": "base", "child": "rod", "axis": [0, 1, 0]}
            ],
            "links": [{"name": "rod", "type": "rigid", "mass": 20.0, "com": [0.5, 0, 0]}],
            "points": [{"name": "tip", "link": "rod", "position": [1, 0, 0]}],
        }
    )
    arm.to_toml(directory / "arm.toml")
    true = arm.with_effect(JointCompliance(at="hinge", stiffness=2e4))
    for name, count in (("poses", 12), ("other", 7)):
        rows = np.array([str(k) for k in range(count)])
        angle = np.linspace(-1.4, 1.4, count)[:, None]
        drive = Signal(name="hinge", quantity="joint_angle", joint="hinge", side="motor", pose=rows,
                       values=angle, file="hinge.csv")  # fmt: skip
        tip = Signal(name="tip", quantity="position", point="tip", pose=rows, values=np.zeros((count, 3)),
                     noise_std=1e-4, file="tip.csv")  # fmt: skip
        bare = Record(kind="static", signals=[drive, tip], drive=("hinge",))
        noise = 1e-4 * np.random.default_rng(count).standard_normal((count, 3))
        seen = tip.replace(values=solve_poses(true, bare).position[:, 0] + noise)
        bare.replace(signals=[drive, seen]).save(directory / name)
    return directory


def command(bench, out, *more):
    return ["calibrate", str(bench / "arm.toml"), str(bench / "poses"), "--hold-out", str(bench / "other"),
            "--out", str(out), "--jobs", "1", *more]  # fmt: skip


def test_a_family_is_fitted_and_written(bench, tmp_path, capsys):
    assert run(command(bench, tmp_path / "out", "--family", "joint_compliance")) == 0
    sentence = "oint compliance, stiffness, at hinge: "
    assert f"j{sentence}" in capsys.readouterr().out
    page = (tmp_path / "out" / "report.html").read_text()
    assert re.search(rf"<p>J{sentence}shared size \S+ kN m/rad, 90", page)
    found = flexarm.Calibration.load(tmp_path / "out")
    stiffness = found.parameter("effects.joint_compliance.hinge.stiffness")
    assert stiffness.low90 < 2e4 < stiffness.high90
    assert found.gap(found.held_out).after_rms < 0.3 * found.gap(found.held_out).before_rms
    assert "arm.toml" in found.provenance["inputs_sha256"]
    assert run(["compare", str(tmp_path / "out" / "updated.toml"), str(bench / "other")]) == 0


def test_json_is_one_object(bench, tmp_path, capsys):
    assert run(command(bench, tmp_path / "out", "--family", "joint_compliance", "--json")) == 0
    told = json.loads(capsys.readouterr().out)
    assert told == json.loads((tmp_path / "out" / "calibration.json").read_text())
    assert told["format"] == "flexarm-calibration/1"


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ([], "nothing to calibrate"),
        (["--family", "joint_complience"], "did you mean 'joint_compliance'"),
        (["--step", "-1"], "must be positive"),
    ],
)
def test_what_cannot_be_is_refused_and_leaves_nothing(bench, tmp_path, capsys, more, said):
    assert run(command(bench, tmp_path / "out", *more)) == 2
    told = capsys.readouterr().err
    assert told.startswith("error: ")
    assert said in told
    assert not (tmp_path / "out").exists()


def test_a_directory_that_holds_files_needs_force(bench, tmp_path, capsys):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "notes.txt").write_text("mine")
    assert run(command(bench, tmp_path / "out", "--family", "joint_compliance")) == 2
    assert run(command(bench, tmp_path / "out", "--family", "joint_compliance", "--force")) == 0
    assert (tmp_path / "out" / "notes.txt").read_text() == "mine"
