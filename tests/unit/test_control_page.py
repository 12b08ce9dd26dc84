"""docs/control.md: its programs run and do what the page says."""

import re
import shlex
import tomllib
from pathlib import Path
from typing import Any

import pytest
from pytest import approx

import flexarm
from flexarm import LinearModel
from flexarm.arm.parameter import with_value
from flexarm.cli.run import run

TEXT = (Path(__file__).parents[2] / "docs" / "control.md").read_text(encoding="utf-8")
PROGRAMS = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)


def test_the_closed_loop_of_ten_lines_brings_the_arm_to_its_command(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A spring of 4000 N m/rad against weight and friction: k (command - angle) = their torque."""
    program = PROGRAMS[0]
    assert len(program.splitlines()) <= 11
    names: dict[str, object] = {}
    exec(program, names)
    hinge = names["sim"].joint(names["state"], "hinge")  # type: ignore[attr-defined]
    assert 4000 * (0.3 - hinge.drive_angle) == approx(hinge.motor_torque, rel=0.05)
    assert hinge.drive_angle == approx(0.34, abs=0.005)  # the weight pulls it beyond its command
    tip = [float(number) for number in capsys.readouterr().out.strip("[] \n").split()]
    assert tip == approx([1.014, 0.0, 2.823], abs=2e-3)  # m: a 3 m arm at 0.34 rad, bent


def test_the_linear_model_of_the_page_is_that_of_its_arm(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The motor let go at 0.5 rad, rotor and all, falls as a pendulum on its bearing would."""
    monkeypatch.chdir(tmp_path)
    exec(PROGRAMS[1], {})
    model = LinearModel.load("arm.mat")
    assert model.input_names == ("hinge.torque",)
    assert model.output_names == ("hinge", "tip.x", "tip.y", "tip.z")
    assert model.poles.real.max() > 0.5
    assert "hinge.torque" in capsys.readouterr().out


def test_the_derivative_of_the_page_is_what_differences_scatter_about(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Steps of the encoder make a run jump with the load; the page says by how much."""
    names: dict[str, Any] = {}
    exec(PROGRAMS[2], names)
    printed = float(capsys.readouterr().out.strip("[] \n"))
    told = re.search(r"is ([\d.]+) N m/kg; differences of runs over ±0.5 kg give ([\d.]+)", TEXT)
    assert told is not None
    assert printed == approx(float(told[1]), abs=0.006)
    heavy, light = (
        flexarm.simulate(with_value(names["arm"], "payloads.load.mass", mass), names["command"], step=1e-3)
        for mass in (14.6, 13.6)
    )
    difference = heavy.motor_torque[-1, 0] - light.motor_torque[-1, 0]
    assert difference == approx(float(told[2]), abs=0.006)
    assert difference == approx(printed, rel=0.1)


def test_the_commands_of_the_page_run(model_file: Path, tmp_path: Path) -> None:
    """On a model of the tests in place of arm.toml."""
    commands = re.findall(r"^    flexarm (linearise .*)$", TEXT, re.MULTILINE)
    assert len(commands) == 2
    for command in commands:
        words = shlex.split(command.replace("arm.toml", str(model_file)))
        words[words.index("--out") + 1] = str(tmp_path / words[words.index("--out") + 1])
        assert run(words) == 0
    assert len(LinearModel.load(tmp_path / "arm.nc").A) == 6


def test_a_faster_loop_of_the_page_follows_its_command_more_closely(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A proportional loop lags by the rate over its gain: twice the gain halves the error."""
    names: dict[str, Any] = {}
    exec(PROGRAMS[3], names)
    errors = names["errors"]
    assert errors["as built"] / errors["faster"] == approx(2, rel=0.1)
    assert "as built" in capsys.readouterr().out
    [table] = tomllib.loads(re.findall(r"```toml\n(.*?)```", TEXT, re.DOTALL)[0])["controllers"]
    assert type(names["cascade"])(**table) == names["cascade"]
