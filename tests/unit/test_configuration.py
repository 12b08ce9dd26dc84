"""What a build says about itself, and what importing it costs."""

import pkgutil
import subprocess
import sys
import tomllib
from pathlib import Path

import flexarm

ROOT = Path(__file__).resolve().parents[2]


def test_version_is_the_one_of_pyproject():
    stated = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert flexarm.__version__ == stated
    assert f"\nversion: {stated}\n" in (ROOT / "CITATION.cff").read_text()


def test_show_config_prints_every_entry_of_config(capsys):
    assert flexarm.show_config() is None
    printed = dict(line.split("  ", 1) for line in capsys.readouterr().out.splitlines())
    assert {name.strip(): value.strip() for name, value in printed.items()} == flexarm.config()


def test_licence_of_the_build_follows_its_solver():
    config = flexarm.config()
    assert config["step factorisation"] in ("KLU", "Eigen SparseLU")
    assert ("LGPL" in config["licence of this build"]) == (config["step factorisation"] == "KLU")


def test_build_is_gpl_as_a_whole_where_cholmod_is_supernodal():
    config = flexarm.config()
    assert config["licence of this build"].startswith("GPL-") == ("supernodal" in config["CHOLMOD"])


def test_blas_is_told_exactly_where_cholmod_calls_one():
    config = flexarm.config()
    assert config["BLAS"].startswith("none") == ("not used" in config["CHOLMOD"])


def test_import_of_flexarm_leaves_heavy_libraries_alone():
    heavy = ["numpy", "scipy", "xarray", "matplotlib", "pydantic"]
    code = f"import flexarm, sys; print(*[name for name in {heavy} if name in sys.modules])"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.split() == []


def test_every_public_name_can_be_imported():
    for name in flexarm.__all__:
        assert getattr(flexarm, name) is not None


def test_no_module_takes_the_place_of_a_public_name():
    modules = {module.name for module in pkgutil.iter_modules(flexarm.__path__)}
    assert modules.isdisjoint(flexarm.__all__)
