"""README.md: its programs run one after the other, as a reader types them, and do what it says."""

import re
from pathlib import Path

import numpy as np
import pytest

import flexarm

ROOT = Path(__file__).parents[2]
PROGRAMS = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL)


def test_the_programs_run_as_printed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for program in PROGRAMS:
        exec(program, names)

    nominal, softer = names["runs"]  # type: ignore[misc]
    stored = flexarm.Simulation.load(tmp_path / "run.nc")
    assert np.array_equal(stored.position, nominal.position)
    # Torque is stiffness times deflection; the arm still swings a little at the end.
    for run, stiffness in ((nominal, 1e5), (softer, 8e4)):
        deflection = run.drive_angle[-1, 0] - run.joint_angle[-1, 0]
        assert run.joint_torque[-1, 0] == pytest.approx(stiffness * deflection, rel=0.05)
