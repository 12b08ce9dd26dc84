"""The diagnosis of the ASEN rotary flexible arm, from the authors' files to the page.

    python make_page.py DATA_DIR OUT_DIR

writes OUT_DIR/records (see make_records.py) and OUT_DIR/page (`flexarm diagnose`: test 3 through controller
and motor, test 2 held out), and prints rms of hub and deflection by the nominal and the repaired model.
"""

from __future__ import annotations

import sys
from pathlib import Path

import make_records

import flexarm
from flexarm import Arm, Record

sys.path.insert(0, str(Path(__file__).parents[1]))
from data_script import command_line, diagnosed, exit_code


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


def make_page(data: Path, out: Path) -> int:
    """Records, page and table; the exit code of the diagnosis."""
    records, page = out / "records", out / "page"
    make_records.make_records(data, records)
    trained, held_out = records / "test_3", records / "test_2"
    code = diagnosed(trained / "arm.toml", trained / "by_reference", held_out / "by_reference", page)
    if code == 0:
        print(gaps(records, page))
    return code


def main() -> int:
    """Command line; 0 if done, 2 if the input is at fault."""
    description = "Diagnosis of the ASEN rotary flexible arm."
    given = command_line(description, make_records.FILES).parse_args()
    return exit_code(lambda: make_page(given.data, given.out))


if __name__ == "__main__":
    sys.exit(main())
