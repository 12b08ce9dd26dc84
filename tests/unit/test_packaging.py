"""Workflows, recipe and wheels say the same as pyproject.toml and the Makefile."""

import re
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))


@pytest.fixture
def scripts(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))


def _steps(file: Path) -> list[str]:
    jobs = yaml.safe_load(file.read_text(encoding="utf-8"))["jobs"]
    return [step["run"] for job in jobs.values() for step in job["steps"] if "run" in step]


@pytest.mark.parametrize("file", WORKFLOWS, ids=lambda file: file.stem)
def test_workflows_call_targets_and_scripts_that_are_there(file):
    targets = set(re.findall(r"^([\w-]+):(?!=)", MAKEFILE, flags=re.M))
    jobs = yaml.safe_load(file.read_text(encoding="utf-8"))["jobs"]
    matrix = {
        target
        for job in jobs.values()
        for target in job.get("strategy", {}).get("matrix", {}).get("target", [])
    }
    called = {word for run in _steps(file) for word in re.findall(r"make ([a-z][\w-]*)", run)} | matrix
    assert called and called <= targets
    for script in (place for run in _steps(file) for place in re.findall(r"scripts/\w+\.\w+", run)):
        assert (ROOT / script).is_file(), script


def test_the_command_that_tries_wheels_is_there():
    assert "scripts/try_wheel.py" in PROJECT["tool"]["cibuildwheel"]["test-command"]
    assert (ROOT / "scripts" / "try_wheel.py").is_file()


def test_the_recipe_asks_for_what_the_package_asks_for():
    text = (ROOT / "recipe" / "recipe.yaml").read_text(encoding="utf-8")
    recipe = yaml.safe_load(text)
    assert recipe["context"]["version"] == PROJECT["project"]["version"]

    def asked(lines):
        pairs = (re.fullmatch(r"([\w-]+?)(?:-base)? ?(>=[\d.]+)", line.lower()) for line in lines)
        return {pair[1]: pair[2] for pair in pairs if pair}

    run = asked(recipe["requirements"]["run"])
    assert run == asked(PROJECT["project"]["dependencies"]) | {
        "python": PROJECT["project"]["requires-python"]
    }
    built = asked(recipe["requirements"]["host"])
    assert built.items() <= asked(PROJECT["build-system"]["requires"]).items() and len(built) == 2


def test_the_full_wheel_says_that_it_is_gpl(scripts):
    import label_full_wheel

    plain = "Metadata-Version: 2.4\nVersion: 0.1.0\nLicense-Expression: BSD-3-Clause\nRequires-Dist: x\n"
    full = label_full_wheel.relabelled(plain)
    assert "Version: 0.1.0+suitesparse\nLicense-Expression: GPL-3.0-or-later\n" in full
    assert full.startswith("Metadata-Version: 2.4\n")


def test_a_wheel_is_tried_without_the_variables_of_this_process(scripts, monkeypatch):
    import try_wheel

    monkeypatch.setenv("LD_LIBRARY_PATH", "/somewhere")
    monkeypatch.setenv("PYTHONPATH", "/elsewhere")
    seen = try_wheel.environment(Path(sys.executable).parent)
    assert {"LD_LIBRARY_PATH", "PYTHONPATH"}.isdisjoint(seen)
    assert seen["PATH"] == str(Path(sys.executable).parent)
