"""The diagnosis of the ASEN rotary flexible arm, from the authors' files to the page.

    python make_page.py DATA_DIR OUT_DIR

writes OUT_DIR/records (see make_records.py) and OUT_DIR/page (`flexarm diagnose`: test 3 through controller
and motor, test 2 held out), and prints rms of hub and deflection by the nominal and the repaired model.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

import make_records

import flexarm
from flexarm import Arm, InvalidParameter, Record


def diagnosed(records: Path, page: Path) -> int:
    """`flexarm diagnose` as from a shell; its exit code."""
    model, training = records / "test_3/arm.toml", records / "test_3/by_reference"
    words = ["diagnose", model, training, "--hold-out", records / "test_2/by_reference", "--out", page]
    return subprocess.run([sys.executable, "-m", "flexarm", *map(str, words)], check=False).returncode


def gaps(records: Path, page: Path) -> str:
    """A line for each test and model: rms of hub [mrad] and deflection [mm]."""
    models = {"nominal": records / "test_3/arm.toml", "repaired": page / "updated.toml"}
    lines = ["rms of hub [mrad] and deflection [mm], clock of the deflection aligned"]
    for test in ("test_3", "test_2"):
        record = Record.load(records / test / "by_reference")
        for name, path in models.items():
            found = flexarm.compare(Arm.from_toml(path), record).signals
            hub, tip = (1e3 * float(found[signal].rms["total"] or 0.0) for signal in ("hub", "tip"))
            lines.append(f"  {test} {name:9s} {hub:6.2f} {tip:6.2f}")
    return "\n".join(lines)


def main() -> int:
    """Command line; 0 if done, 2 if the input is at fault."""
    parser = argparse.ArgumentParser(description="Diagnosis of the ASEN rotary flexible arm.")
    parser.add_argument("data", type=Path, metavar="DATA_DIR", help="holds test_2.tsv and test_3.tsv")
    parser.add_argument("out", type=Path, metavar="OUT_DIR", help="a new or empty directory")
    given = parser.parse_args()
    records, page = given.out / "records", given.out / "page"
    try:
        make_records.make_records(given.data, records)
    except InvalidParameter as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    code = diagnosed(records, page)
    if code == 0:
        print(gaps(records, page))
    return code


if __name__ == "__main__":
    sys.exit(main())
