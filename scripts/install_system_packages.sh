#!/usr/bin/env bash
# Packages of a list from Debian or Ubuntu, by default compiler and libraries of the build: installed as root, else
# named in one line to type.
set -euo pipefail
cd "$(dirname "$0")/.."
python="${1:-python3}" list="${2:-scripts/system-packages.txt}"

is_there() { # kind, what
  case "$1" in
    command) command -v "$2" > /dev/null ;;
    file) compgen -G "$2" > /dev/null ;;
    header) "$python" -c "import sysconfig, pathlib, sys; sys.exit(not pathlib.Path(sysconfig.get_path('include'), '$2').exists())" ;;
    module) "$python" -c "import $2" 2> /dev/null ;;
  esac
}

if ! "$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2> /dev/null; then
  echo "flexarm needs Python 3.11 or newer; '$python' is not (make PYTHON=/path/to/python3 names another one)" >&2
  exit 1
fi

missing=()
while read -r package kind what; do
  [[ -z "$package" || "$package" == \#* ]] && continue
  is_there "$kind" "$what" || missing+=("$package")
done < "$list"
[[ ${#missing[@]} -eq 0 ]] && exit 0

install="apt-get update && apt-get install -y --no-install-recommends ${missing[*]}"
if ! command -v apt-get > /dev/null; then
  echo "Not seen here, by their Debian names: ${missing[*]}. Going on; CMake tells what it cannot find." >&2
elif [[ "$(id -u)" -eq 0 ]]; then
  echo "Installing ${missing[*]}"
  export DEBIAN_FRONTEND=noninteractive
  apt-get update -qq
  apt-get install -y -qq --no-install-recommends "${missing[@]}" < /dev/null > /dev/null
else
  echo "Packages are missing (${missing[*]}). Please type:" >&2
  echo "  sudo sh -c '$install'" >&2
  exit 1
fi
