"""docs/control.md: its programs run and do what the page says."""

import re
from pathlib import Path

import pytest
from pytest import approx

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
    assert capsys.readouterr().out.startswith("[1.0")
