#!/usr/bin/env bash
# The virtual environment with what pyproject.toml asks for, and flexarm itself where its sources lie.
set -euo pipefail
cd "$(dirname "$0")/.."
python="$1" venv="$2"

if ! "$venv/bin/python" -c '' 2> /dev/null; then
  echo "Making $venv"
  "$python" -m venv --clear "$venv"
fi
mapfile -t build_requires < <("$venv/bin/python" -c '
import pathlib, tomllib
print(*tomllib.loads(pathlib.Path("pyproject.toml").read_text())["build-system"]["requires"], sep="\n")')
echo "Installing Python packages into $venv"
"$venv/bin/python" -m pip install --quiet --upgrade "pip>=24" "${build_requires[@]}"
# CMake builds the module into python/flexarm (preset release), so pip leaves it alone here.
"$venv/bin/python" -m pip install --quiet --no-build-isolation \
  -C wheel.cmake=false -C editable.mode=inplace --editable '.[dev]'
