#!/usr/bin/env bash
# One layer of the virtual environment from pyproject.toml: tools (what builds the module), run (flexarm itself,
# where its sources lie) or dev (what tests it).
set -euo pipefail
cd "$(dirname "$0")/.."
python="$1" venv="$2" layer="$3"

# Python compiles a module when it imports it first; pip would compile all of them, beside the compiler.
install() { "$venv/bin/python" -m pip install --quiet --no-compile "$@"; }

echo "Installing Python packages into $venv: $layer"
case "$layer" in
  tools)
    "$venv/bin/python" -c '' 2> /dev/null || "$python" -m venv --clear "$venv"
    mapfile -t build_requires < <("$venv/bin/python" -c '
import pathlib, tomllib
print(*tomllib.loads(pathlib.Path("pyproject.toml").read_text())["build-system"]["requires"], sep="\n")')
    install --upgrade "pip>=24" cmake ninja "${build_requires[@]}"
    ;;
  # CMake builds the module into python/flexarm (preset release), so pip leaves it alone here.
  run) install --no-build-isolation -C wheel.cmake=false -C editable.mode=inplace --editable . ;;
  dev) install --no-build-isolation -C wheel.cmake=false -C editable.mode=inplace --editable '.[dev]' ;;
esac
