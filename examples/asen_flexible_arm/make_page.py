"""The diagnosis of the ASEN rotary flexible arm, from the authors' files to the page.

    python make_page.py DATA_DIR OUT_DIR [--jobs N] [--force]

writes OUT_DIR/records (see make_records.py) and OUT_DIR/page, what `flexarm diagnose` writes: test 3 through
controller and motor, test 2 held out. Prints the diagnosis, and rms of hub and deflection by the nominal and
by the repaired model.
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


def make_page(data: Path, out: Path, jobs: int | None, force: bool) -> None:
    """Records, page and table; all of it or nothing."""
    with output_directory(out, force) as directory:
        records, page = directory / "records", directory / "page"
        make_records.make_records(data, records)
        trained, held_out = (records / test / "by_reference" for test in ("test_3", "test_2"))
        diagnosed(records / "test_3/arm.toml", [trained], held_out, page, jobs)
        print(gaps(records, page))
    print(f"\nwritten to {out}: open {out / 'page/report.html'}")


def main() -> int:
    """Command line; 0 if done, 2 if the input is at fault."""
    description = "Diagnosis of the ASEN rotary flexible arm."
    given = page_command_line(description, make_records.FILES).parse_args()
    return exit_code(lambda: make_page(given.data, given.out, given.jobs, given.force))


if __name__ == "__main__":
    sys.exit(main())
