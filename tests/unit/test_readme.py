"""README.md: its commands and programs run one after the other, as typed by a reader, and do what it says."""

import re
import shlex
import tomllib
from pathlib import Path

import numpy as np
import pytest
from pytest import approx

import flexarm
from flexarm.cli.run import run

pytestmark = pytest.mark.slow

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```(\w*)\n(.*?)```", README, re.DOTALL)
PROGRAMS = [text for language, text in BLOCKS if language == "python"]
SHELL = [line for language, text in BLOCKS if not language for line in text.splitlines()]
IN_PROSE = [" ".join(text.split()) for text in re.findall(r"`(flexarm [^`]*\.toml [^`]*)`", README)]


@pytest.fixture(scope="module")
def tryout(tmp_path_factory):
    """The directory where every command of the page was typed."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("reader"))
        for line in [*SHELL, *IN_PROSE]:
            program, *arguments = shlex.split(line, comments=True)
            if program == "cd":
                patch.chdir(arguments[0])
            elif program == "flexarm":
                assert run(arguments) == 0, line
        return Path.cwd()


def test_every_command_that_names_a_file_was_typed(tryout):
    """The page has commands in blocks and in its prose; those left out only name a command."""
    typed = {shlex.split(line)[1] for line in [*SHELL, *IN_PROSE] if line.startswith("flexarm ")}
    wanted = {
        "example",
        "check",
        "static",
        "simulate",
        "compare",
        "diagnose",
        "plan",
        "linearise",
        "reduce",
        "view",
    }
    assert typed == wanted
    made = {path.name for path in tryout.iterdir()}
    assert made >= {"run", "diagnosis", "arm.mat", "bracket.nc"}


def test_the_example_s_secret_is_found(tryout):
    """The gap that the virtual machine has lies in the interval that the diagnosis gives."""
    hidden = flexarm.Arm.from_toml(tryout / "machine.toml").effect("backlash", "hinge").gap
    repaired = tomllib.loads((tryout / "diagnosis" / "updated.toml").read_text(encoding="utf-8"))
    [found] = [effect["gap"] for effect in repaired["effects"] if effect["name"] == "backlash"]
    assert found == approx(hidden, rel=0.01)


def test_the_records_say_that_they_are_virtual(tryout):
    for name in ("slow", "fast", "other_day"):
        assert flexarm.Record.load(tryout / name).description.startswith("virtual")


def test_the_programs_run_as_printed(tryout: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tryout)
    first, second = ({}, {})  # each program imports what it uses
    for program, names in zip(PROGRAMS, (first, second), strict=True):
        exec(program, names)

    nominal, softer = second["runs"]
    stored = flexarm.Simulation.load(tryout / "run.nc")
    assert np.array_equal(stored.position, first["run"].position)
    # Torque is stiffness times deflection; the arm still swings a little at the end.
    for each, stiffness in ((nominal, 1e5), (softer, 8e4)):
        deflection = each.drive_angle[-1, 0] - each.joint_angle[-1, 0]
        assert each.joint_torque[-1, 0] == approx(stiffness * deflection, rel=0.05)
