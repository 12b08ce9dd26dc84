"""Claims about what a short run loads: packages that take longer to import than the run itself stay away."""

import json
import subprocess
import sys
from textwrap import dedent

import pytest
from arms import paper_arm

HEAVY = {"h5netcdf", "jinja2", "matplotlib", "meshlane", "pandas", "pyvista", "scipy", "xarray"}


def loaded_by(code: str, directory) -> set[str]:
    """Top-level packages in memory after some code in a fresh interpreter."""
    tell = "\nimport json, sys\nprint(json.dumps(sorted({name.partition('.')[0] for name in sys.modules})))"
    command = [sys.executable, "-c", dedent(code) + tell]
    done = subprocess.run(command, cwd=directory, capture_output=True, text=True, check=True)
    return set(json.loads(done.stdout.splitlines()[-1]))


def test_import_loads_neither_numpy_nor_pydantic(tmp_path):
    assert not loaded_by("import flexarm", tmp_path) & {"numpy", "pydantic", *HEAVY}


@pytest.fixture
def swing(tmp_path):
    paper_arm(1).to_toml(tmp_path / "arm.toml")
    (tmp_path / "swing.csv").write_text("time_s,hinge\n0,0\n0.1,0.001\n0.2,0.002\n0.3,0.002\n")
    return tmp_path


def test_a_run_to_its_arrays_loads_nothing_heavy(swing):
    code = """
        import flexarm
        arm = flexarm.Arm.from_toml("arm.toml")
        flexarm.simulate(arm, flexarm.Drive.from_csv("swing.csv", arm)).position
    """
    assert not loaded_by(code, swing) & HEAVY


def test_a_run_from_the_shell_to_its_files_loads_nothing_heavy(swing):
    code = """
        from flexarm.cli.run import run
        assert run(["simulate", "arm.toml", "--drive", "swing.csv", "--out", "run"]) == 0
    """
    assert not loaded_by(code, swing) & HEAVY
    assert {path.name for path in (swing / "run").iterdir()} >= {"simulation.nc", "record.toml"}
