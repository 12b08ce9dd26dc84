"""Write python/flexarm/_core.pyi from the built module, or with --check compare it with the committed one."""

import argparse
import difflib
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
COMMITTED = ROOT / "python" / "flexarm" / "_core.pyi"


def generate() -> str:
    """Text of the stub, laid out by ruff."""
    with tempfile.TemporaryDirectory() as folder:
        stub = Path(folder) / "flexarm" / "_core.pyi"
        config = ["--quiet", "--config", str(ROOT / "pyproject.toml")]
        enums = ["--enum-class-locations", ".+:flexarm._core"]  # enumerations among default values
        run_module("pybind11_stubgen", "flexarm._core", "--exit-code", *enums, "--output-dir", folder)
        run_module("ruff", "check", "--fix-only", "--select", "I,F401", *config, str(stub))
        run_module("ruff", "format", *config, str(stub))
        return with_enum_members(stub.read_text())


def with_enum_members(text: str) -> str:
    """Members of enums as the typing specification wants them, `name = ...`, and no untyped `__new__`."""
    for enum in re.findall(r"^class (\w+)\(enum\.Enum\):", text, flags=re.MULTILINE):
        text = text.replace(f": typing.ClassVar[{enum}]", " = ...")
    return text.replace("    @classmethod\n    def __new__(cls, value): ...\n", "")


def run_module(*arguments: str) -> None:
    """Run `python -m arguments` in the root of the project."""
    subprocess.run([sys.executable, "-m", *arguments], check=True, cwd=ROOT)


def main() -> int:
    """Exit code 1 if the committed stub is out of date."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true")
    check = parser.parse_args().check
    new = generate()
    if not check:
        COMMITTED.write_text(new)
        return 0
    old = COMMITTED.read_text()
    diff = difflib.unified_diff(old.splitlines(True), new.splitlines(True), COMMITTED.name, "built")
    sys.stdout.writelines(diff)
    if old != new:
        print("The stubs of flexarm._core are out of date: make stubs")
    return int(old != new)


if __name__ == "__main__":
    sys.exit(main())
