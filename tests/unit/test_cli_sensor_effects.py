"""Effects of sensors on the command line: written, warned about, refused, and compared."""

import json
from pathlib import Path

import numpy as np
import pytest

from flexarm import Record
from flexarm.cli.run import run

EXAMPLES = Path(__file__).parents[2] / "examples"
EFFECTS = """
[[effects]]
name = "sign_error"
at = "tip"
channels = ["x"]

[[effects]]
name = "encoder_scale"
at = "hinge"
scale = 1.001

[[effects]]
name = "time_delay"
at = "clock"
delay = 0.25
"""
LOST = '\n[[effects]]\nname = "frame_drift"\nat = "tracker"\nvelocity = [1e-6, 0, 0]\n'


@pytest.fixture
def model(tmp_path: Path) -> Path:
    path = tmp_path / "arm.toml"
    path.write_text((EXAMPLES / "one_link.toml").read_text() + EFFECTS)
    return path


@pytest.fixture
def drive(tmp_path: Path) -> Path:
    path = tmp_path / "drive.csv"
    t = np.linspace(0, 1, 101)
    rows = [f"{a},{0.1 * a**3}" for a in t]
    path.write_text("time_s,hinge\n" + "\n".join(rows) + "\n")
    return path


def test_what_simulate_writes_compare_explains(
    model: Path, drive: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """hinge: 1.001 of the angle, 0.25 s late; tip: x the other way."""
    out = tmp_path / "run"
    assert run(["simulate", str(model), "--drive", str(drive), "--out", str(out)]) == 0
    assert capsys.readouterr().err == ""
    record = Record.load(out)
    hinge, tip = record.signals["hinge"], record.signals["tip"]
    assert hinge.time[0] == pytest.approx(0.25)
    assert hinge.values[-1, 0] == pytest.approx(0.1001)
    assert tip.values[-1, 0] < -0.25  # 3 m x 0.1 rad towards -x
    assert run(["compare", str(model), str(out), "--json"]) == 0
    gaps = json.loads(capsys.readouterr().out)["signals"]
    assert gaps["tip"]["max"]["total"] < 1e-9
    assert gaps["hinge"]["max"]["total"] < 1e-12


def test_an_effect_at_a_place_that_nothing_has_is_a_warning(
    model: Path, drive: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model.write_text(model.read_text() + LOST)
    out = tmp_path / "run"
    assert run(["simulate", str(model), "--drive", str(drive), "--out", str(out)]) == 0
    said = "effects.frame_drift.tracker: acts on nothing in this record: there is no frame 'tracker'"
    assert capsys.readouterr().err.startswith(f"warning: {model}: {said}")
    assert run(["compare", str(model), str(out)]) == 0
    told = capsys.readouterr()
    assert said in told.err and "frame_drift.tracker acts on nothing" in told.out


def test_an_effect_that_cannot_act_on_its_signal_is_refused(
    model: Path, drive: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model.write_text(model.read_text().replace('at = "hinge"\nscale', 'at = "tip"\nscale'))
    arguments = ["simulate", str(model), "--drive", str(drive), "--out", str(tmp_path / "run")]
    assert run(arguments) == 2
    said = "effects.encoder_scale.tip: acts on joint_angle, but 'tip' measures position"
    assert said in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


def test_check_tells_channels(model: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["check", str(model)]) == 0
    told = capsys.readouterr().out
    assert "effect sign_error at tip, channels x\n" in told
    assert "effect time_delay at clock: delay = 0.25 s\n" in told
