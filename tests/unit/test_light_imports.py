"""Claims about what a short run loads: packages that take longer to import than the run itself stay away."""

import ast
import importlib.util
import json
import subprocess
import sys
from pathlib import Path
from textwrap import dedent

import pytest
from arms import paper_arm

ROOT = Path(__file__).parents[2]
HEAVY = {"h5netcdf", "jinja2", "matplotlib", "meshlane", "pandas", "pyvista", "rich", "scipy", "xarray"}
NEEDLESS = {
    "flexarm.cli.diagnose",
    "flexarm.record.file_table",
    "numpy.random",
    "tqdm",
    "xml.etree.ElementTree",
}
"""What other commands, records as drives, sensors, terminals and URDF files need, some 40 ms together."""


def last_line(code: str, directory) -> str:
    """What some code prints last in a fresh interpreter."""
    command = [sys.executable, "-c", dedent(code)]
    done = subprocess.run(command, cwd=directory, capture_output=True, text=True, check=True)
    return done.stdout.splitlines()[-1]


def loaded_by(code: str, directory) -> set[str]:
    """Packages and modules in memory after some code in a fresh interpreter."""
    tell = "\nimport json, sys\nprint(json.dumps(sorted(sys.modules)))"
    return set(json.loads(last_line(dedent(code) + tell, directory)))


def test_import_loads_neither_numpy_nor_pydantic(tmp_path):
    assert not loaded_by("import flexarm", tmp_path) & {"numpy", "pydantic", *HEAVY}


def test_a_command_handles_signals_before_it_imports_what_takes_time(tmp_path):
    begun = loaded_by("import flexarm.cli", tmp_path) - loaded_by("", tmp_path)
    assert not begun & {"dataclasses", "inspect", "numpy", "typer", "typing"}
    assert {name for name in begun if name.startswith("flexarm")} == {
        "flexarm",
        "flexarm.cli",
        "flexarm.termination",
    }


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
    assert not loaded_by(code, swing) & (HEAVY | NEEDLESS)
    assert {path.name for path in (swing / "run").iterdir()} >= {"simulation.nc", "record.toml"}


def test_a_run_from_the_shell_never_looks_through_all_objects_for_garbage(swing):
    """What imports make stays to the end: to look through it, at the end too, took a tenth of the run."""
    code = """
        import atexit, gc
        from flexarm.cli import main
        seen = []
        gc.callbacks.append(lambda phase, info: seen.append(info["generation"]))
        atexit.register(lambda: print(seen.count(2), gc.get_freeze_count() > 10_000))
        main(["simulate", "arm.toml", "--drive", "swing.csv", "--out", "run"])
    """
    assert last_line(code, swing) == "0 True"


@pytest.mark.parametrize("folder", ["benchmarks", "scripts", "examples"])
def test_what_programs_beside_the_package_import_from_it_is_there(folder):
    for path in sorted((ROOT / folder).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "flexarm":
                module = importlib.import_module(str(node.module))
                for name in (alias.name for alias in node.names):
                    inside = hasattr(module, "__path__") and importlib.util.find_spec(f"{node.module}.{name}")
                    assert hasattr(module, name) or inside, f"{path}: {node.module}.{name}"
