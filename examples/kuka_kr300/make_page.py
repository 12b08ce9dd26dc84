"""The calibration of the KUKA KR 300, from the authors' files to the page.

    python make_page.py DATA_DIR OUT_DIR [--jobs N] [--force]

writes OUT_DIR/records (see make_records.py) and OUT_DIR/page, what `flexarm calibrate --family
joint_compliance` writes: robot.toml, fitted to the encoders of trajectory a, with b held out. Prints the
calibration beside what the encoders say by hand (see by_hand.py).
"""

from __future__ import annotations

import sys
from pathlib import Path

import by_hand
import make_records

import flexarm
from flexarm import Arm, Record
from flexarm.cli.progress import progress
from flexarm.output import output_directory

sys.path.insert(0, str(Path(__file__).parents[1]))
from data_script import exit_code, page_command_line


def calibrated(records: Path, page: Path, jobs: int | None) -> None:
    """Fits delay, zeros and compliances to a; saves the page."""
    with progress() as tell:
        found = flexarm.calibrate(
            Arm.from_toml(records / "robot.toml"),
            {"a": Record.load(records / "a")},
            ["joint_compliance"],
            Record.load(records / "b"),
            n_jobs=jobs,
            progress=tell,
        )
    found.save(page)
    print(f"{found.summary()}\n")


def make_page(data: Path, out: Path, jobs: int | None, force: bool) -> None:
    """Records, page and values by hand; all of it or nothing."""
    with output_directory(out, force) as directory:
        make_records.make_records(data, directory / "records")
        calibrated(directory / "records", directory / "page", jobs)
        by_hand.show(data)
    print(f"\nwritten to {out}: open {out / 'page/report.html'}")


def main() -> int:
    """Command line; 0 if done, 2 if the input is at fault."""
    files = " and ".join(make_records.FILES.values())
    given = page_command_line("Calibration of the KUKA KR 300.", files).parse_args()
    return exit_code(lambda: make_page(given.data, given.out, given.jobs, given.force))


if __name__ == "__main__":
    sys.exit(main())
