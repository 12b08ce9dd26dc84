"""Versions, backends and the licence of this installation."""

import platform
import subprocess
from functools import cache
from pathlib import Path

from flexarm import _core


def version() -> str:
    """Version of flexarm, as stated in pyproject.toml when the core was built."""
    return _core.build_info().version


@cache
def config() -> dict[str, str]:
    """Return versions and backends that results depend on; every result records them.

    Returns
    -------
    config : dict
        Name of the part and what it is, in the order of :func:`show_config`.
    """
    import numpy as np

    core = _core.build_info()
    return {
        "flexarm": core.version,
        "git": _git_of_checkout() or core.git or "unknown",
        "Python": platform.python_version(),
        "NumPy": np.__version__,
        "Eigen": core.eigen,
        "SuiteSparse": core.suitesparse or "not used",
        "CHOLMOD": core.cholmod,
        "step factorisation": core.solver,
        "ordering": core.ordering,
        "BLAS": core.blas,
        "compiler": f"{core.compiler}, {core.build_type}",
        "platform": platform.platform(),
        "licence of this build": core.licence,
    }


def show_config() -> None:
    """Print versions, backends, ordering, BLAS, compiler and the licence of this build."""
    entries = config()
    width = max(map(len, entries))
    for name, value in entries.items():
        print(f"{name:<{width}}  {value}")


def _git_of_checkout() -> str:
    """Commit of the checkout this package is used from; empty for an installed package."""
    root = Path(__file__).resolve().parents[2]
    if not (root / ".git").exists() or not (root / "CMakeLists.txt").exists():
        return ""
    command = ["git", "-C", str(root), "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True, timeout=5).stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return ""
