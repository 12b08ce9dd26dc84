"""The diagnosis of the Hilti construction robot, from the makers' files to the page.

    python make_page.py DATA_DIR OUT_DIR [--every N] [--jobs N] [--force]

writes OUT_DIR/records (see make_records.py) and OUT_DIR/page, what `flexarm diagnose` writes: robot.toml,
fitted to the level floor, with the pallet held out. Prints the diagnosis, and what neither fit nor page saw:
the accelerometers on the column, by the nominal and by the repaired model.
"""

from __future__ import annotations

import sys
from pathlib import Path

import make_records

import flexarm
from flexarm import Arm, Record
from flexarm.output import output_directory

sys.path.insert(0, str(Path(__file__).parents[1]))
from data_script import diagnosed, exit_code, page_command_line


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


def make_page(data: Path, out: Path, every: int, jobs: int | None, force: bool) -> None:
    """Records, page and accelerometers; all of it or nothing."""
    with output_directory(out, force) as directory:
        records, page = directory / "records", directory / "page"
        make_records.make_records(data, records, every)
        diagnosed(records / "robot.toml", [records / "flat"], records / "pallet", page, jobs)
        print(felt(records, page))
    print(f"\nwritten to {out}: open {out / 'page/report.html'}")


def main() -> int:
    """Command line; 0 if done, 2 if the input is at fault."""
    description = "Diagnosis of the Hilti construction robot."
    parser = page_command_line(description, "flat.yaml, pallet.yaml and trailblazer.urdf")
    parser.add_argument("--every", type=int, default=6, metavar="N", help="take one of N poses (default 6)")
    given = parser.parse_args()
    return exit_code(lambda: make_page(given.data, given.out, max(given.every, 1), given.jobs, given.force))


if __name__ == "__main__":
    sys.exit(main())
