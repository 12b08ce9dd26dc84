"""The calibration of Agile Justin, from its makers' poses to the page.

    python make_page.py DATA_DIR OUT_DIR [--jobs N] [--force]

writes OUT_DIR/records (see make_records.py) and, for each step of `LADDER`, what `flexarm calibrate` writes:
fitted to three poses in four. Prints the mean distance at the hands that each step leaves [mm].
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import make_records
import numpy as np

import flexarm
from flexarm import Arm, Calibration, Record
from flexarm.output import output_directory

sys.path.insert(0, str(Path(__file__).parents[1]))
from data_script import exit_code, page_command_line

PLACES = ("points.", "joints.right_shoulder", "joints.left_shoulder")
LADDER = (
    ("places", PLACES, ()),
    ("zeros", PLACES, ("encoder_offset",)),
    ("joints", ("points.", "joints."), ("encoder_offset",)),
    ("compliance", ("",), ("encoder_offset", "joint_compliance")),
    ("tilt", ("",), ("encoder_offset", "joint_compliance", "joint_tilt_compliance")),
)
"""Name of a step, beginnings of the keys that are uncertain in it, and its families."""


def mean_distance(arm: Arm, record: Record) -> float:
    """Mean distance of measured and predicted markers, both hands, the camera registered anew [m]."""
    gaps = flexarm.compare(arm, record).signals
    parts = [
        [part for part in gaps[side].parts.values() if part is not None] for side in make_records.MARKERS
    ]
    return float(np.mean([np.linalg.norm(each, axis=0) for each in parts]))


def calibrated(
    records: Path, keys: tuple[str, ...], families: tuple[str, ...], jobs: int | None
) -> Calibration:
    """A step of the ladder."""
    from flexarm.cli.progress import progress

    arm = Arm.from_toml(records / "justin.toml")
    uncertain = {key: sigma for key, sigma in arm.uncertainty.items() if key.startswith(keys)}
    with progress() as tell:
        return flexarm.calibrate(
            arm.replace(uncertainty=uncertain),
            {"training": Record.load(records / "training")},
            families,
            Record.load(records / "held_out"),
            n_jobs=jobs,
            progress=tell,
        )


def make_page(data: Path, out: Path, jobs: int | None, force: bool) -> None:
    """Records and a calibration a step; all of it or nothing."""
    with output_directory(out, force) as directory:
        records = directory / "records"
        make_records.make_records(data, records)
        parts = {name: Record.load(records / name) for name in ("training", "held_out")}
        print("mean distance at the hands [mm]: step, training, held out, seconds of CPU")
        for step, keys, families in LADDER:
            began = time.process_time()
            found = calibrated(records, keys, families, jobs)
            found.save(directory / step)
            left = [1e3 * mean_distance(found.updated, record) for record in parts.values()]
            print(
                f"  {step:12s} {left[0]:6.2f} {left[1]:6.2f} {time.process_time() - began:6.0f}", flush=True
            )
    print(f"\nwritten to {out}: open {out / LADDER[-1][0] / 'report.html'}")


def main() -> int:
    """Command line; 0 if done, 2 if the input is at fault."""
    given = page_command_line("Calibration of Agile Justin.", "poses.csv").parse_args()
    return exit_code(lambda: make_page(given.data, given.out, given.jobs, given.force))


if __name__ == "__main__":
    sys.exit(main())
