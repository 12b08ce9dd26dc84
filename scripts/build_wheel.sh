#!/usr/bin/env bash
# A self-contained wheel for Linux: build_wheel.sh PYTHON KIND FOLDER. Kinds are `bsd`, which holds no part under the
# LGPL or GPL, and `full`, which brings SuiteSparse and its BLAS and is GPL as a whole. Both are compiled in
# build/wheel/cmake.
set -euo pipefail
cd "$(dirname "$0")/.."
python="$1" kind="$2" folder="$3"
case "$kind" in
  bsd) suitesparse=OFF ;;
  full) suitesparse=SYSTEM ;;
  *) echo "the kind of a wheel must be bsd or full, got '$kind'" >&2 && exit 2 ;;
esac
if [[ "$(uname)" != Linux ]]; then
  echo "make wheel needs Linux, whose libraries auditwheel knows; elsewhere 'make wheels' runs cibuildwheel" >&2
  exit 1
fi
raw="build/wheel/raw/$kind"
rm -rf "$raw" && mkdir -p "$raw" "$folder"
"$python" -m pip wheel . --quiet --no-deps --no-build-isolation --wheel-dir "$raw" -C build-dir=build/wheel/cmake \
  -C cmake.define.FLEXARM_SUITESPARSE="$suitesparse"
if [[ "$kind" == full ]]; then
  "$python" scripts/label_full_wheel.py "$raw"
fi
rm -f "$folder"/flexarm-*.whl
PATH="$(dirname "$python"):$PATH" "$python" -m auditwheel --verbose repair --wheel-dir "$folder" "$raw"/flexarm-*.whl \
  > "$raw/auditwheel.log" 2>&1 || { tail -n 20 "$raw/auditwheel.log" >&2; exit 1; }
du -h "$folder"/flexarm-*.whl
