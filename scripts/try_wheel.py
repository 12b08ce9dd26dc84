"""Try an installation as a user does: python scripts/try_wheel.py [WHEEL].

A wheel is installed into a new environment in an empty folder; without one, this Python's flexarm is tried.
Variables lead commands to no compiler and no library; LD_LIBRARY_PATH is not set. On Linux, each library of
the module must lie in the environment or belong to every system. Sizes and seconds are printed.
"""

import os
import re
import subprocess
import sys
import sysconfig
import time
import venv
from pathlib import Path
from tempfile import TemporaryDirectory

OF_EVERY_SYSTEM = r"(linux-vdso|ld-linux.*|lib(c|m|stdc\+\+|gcc_s|pthread|dl|rt))\.so.*"
COMMANDS = """
example tryout
check tryout/arm.toml
static tryout/arm.toml --joint hinge=1.2
simulate tryout/arm.toml --drive tryout/swing.csv --out tryout/run
compare tryout/arm.toml tryout/run
check tryout/arm.toml tryout/run
reduce tryout/bracket.inp --unit mm --interface foot=BORE --interface hand=FLANGE --out tryout/bracket.nc
"""


def environment(scripts: Path) -> dict[str, str]:
    """Return variables with nothing in them but the environment's own commands."""
    kept = {
        key: os.environ[key]
        for key in ("HOME", "TEMP", "TMP", "SYSTEMROOT", "USERPROFILE")
        if key in os.environ
    }
    nothing = {"MPLBACKEND": "Agg", "PYTHONNOUSERSITE": "1"}
    network = {
        key: value
        for key, value in os.environ.items()
        if key.startswith(("PIP_", "SSL_", "http", "HTTP", "no_proxy"))
    }
    return {**kept, **network, **nothing, "PATH": str(scripts)}


def foreign_libraries(python: Path, variables: dict[str, str], folder: Path) -> list[str]:
    """Return the libraries of the module that are neither in the environment nor part of every system."""
    code = "import flexarm._core as core; print(core.__file__)"
    module = subprocess.check_output([python, "-c", code], env=variables, cwd=folder, text=True).strip()
    listed = subprocess.check_output(["/usr/bin/ldd", module], env=variables, text=True)
    inside = Path(module).parents[1]
    found = []
    for line in listed.splitlines():
        name, _, place = line.strip().partition(" => ")
        place = place.split(" (")[0]
        if (
            not re.fullmatch(OF_EVERY_SYSTEM, Path(name.split(" ")[0]).name)
            and inside not in Path(place).parents
        ):
            found.append(line.strip())
    return found


def timed(command: list[str | Path], **options: object) -> float:
    start = time.perf_counter()
    subprocess.run(command, check=True, **options)  # type: ignore[call-overload]
    return time.perf_counter() - start


def attempt(python: Path, scripts: Path, folder: Path) -> None:
    """Run the commands in an empty folder."""
    variables = environment(scripts)
    for line in COMMANDS.strip().splitlines():
        command = [scripts / "flexarm", *line.split()]
        seconds = timed(command, env=variables, cwd=folder, stdout=subprocess.DEVNULL)
        print(f"{seconds:8.1f} s   flexarm {line}")
    if sys.platform == "linux" and (foreign := foreign_libraries(python, variables, folder)):
        sys.exit("libraries from outside the environment:\n" + "\n".join(foreign))
    shown = [python, "-c", "import flexarm; flexarm.show_config()"]
    subprocess.run(shown, env=variables, cwd=folder, check=True)


def main(arguments: list[str]) -> None:
    """Try the wheel that is named, or what is installed."""
    with TemporaryDirectory() as empty:
        folder = Path(empty)
        if not arguments:
            attempt(Path(sys.executable), Path(sysconfig.get_path("scripts")), folder)
            return
        (wheel,) = map(Path, arguments)
        inside = folder / "venv"
        made = venv.EnvBuilder(with_pip=True, symlinks=os.name != "nt")
        made.create(inside)
        scripts = inside / ("Scripts" if os.name == "nt" else "bin")
        python = scripts / ("python.exe" if os.name == "nt" else "python")
        pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        others = timed([*pip, "--only-binary=:all:", wheel.absolute()], env=environment(scripts), cwd=folder)
        alone = timed(
            [*pip, "--no-deps", "--force-reinstall", wheel.absolute()], env=environment(scripts), cwd=folder
        )
        print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB")
        print(f"installed in {others:.1f} s with what it needs, in {alone:.1f} s alone")
        attempt(python, scripts, folder)
    print(f"{wheel.name}: installs and runs")


if __name__ == "__main__":
    sys.stdout.reconfigure(line_buffering=True)  # type: ignore[union-attr]
    main(sys.argv[1:])
