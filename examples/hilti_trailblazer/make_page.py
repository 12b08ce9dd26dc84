"""The diagnosis of the Hilti construction robot, from the makers' files to the page.

    python make_page.py DATA_DIR OUT_DIR [--every N]

writes OUT_DIR/records (see make_records.py) and OUT_DIR/page (`flexarm diagnose`: robot.toml, fitted to the
level floor, with the pallet held out), and prints what neither fit nor page saw: the accelerometers on the
column, by the nominal and by the repaired model.
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
    training, held_out = records / "flat", records / "pallet"
    words = ["diagnose", records / "robot.toml", training, "--hold-out", held_out, "--out", page]
    return subprocess.run([sys.executable, "-m", "flexarm", *map(str, words)], check=False).returncode


def variation(arm: Arm, record: Record) -> dict[str, float]:
    """Of the gap of the column's accelerometers over the poses, by axis [m/s2].

    Along x the column's pitch shows, along y its roll; their means hold how the sensors are glued on.
    """
    parts = flexarm.compare(arm, record).signals["column_tilt"].parts
    return {axis: float(parts[axis].std()) for axis in ("x", "y")}


def felt(records: Path, page: Path) -> str:
    """A line for each floor and axis: variation before and after the repair."""
    nominal = Arm.from_toml(records / "robot.toml")
    updated = Arm.from_toml(page / "updated.toml")
    lines = ["accelerometers on the column, rms about their mean [mm/s2]: nominal, repaired"]
    for floor in ("flat", "pallet"):
        record = Record.load(records / f"{floor}_tilt")
        before, after = variation(nominal, record), variation(updated, record)
        lines += [
            f"  {floor:7s} {axis}  {1e3 * before[axis]:6.2f}  {1e3 * after[axis]:6.2f}" for axis in "xy"
        ]
    return "\n".join(lines)


def main() -> int:
    """Command line; 0 if done, 2 if the input is at fault."""
    parser = argparse.ArgumentParser(description="Diagnosis of the Hilti construction robot.")
    parser.add_argument("data", type=Path, metavar="DATA_DIR", help="holds flat.yaml, pallet.yaml, the URDF")
    parser.add_argument("out", type=Path, metavar="OUT_DIR", help="a new or empty directory")
    parser.add_argument("--every", type=int, default=6, metavar="N", help="take one of N poses (default 6)")
    given = parser.parse_args()
    records, page = given.out / "records", given.out / "page"
    try:
        make_records.make_records(given.data, records, max(given.every, 1))
    except InvalidParameter as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    code = diagnosed(records, page)
    if code == 0:
        print(felt(records, page))
    return code


if __name__ == "__main__":
    sys.exit(main())
