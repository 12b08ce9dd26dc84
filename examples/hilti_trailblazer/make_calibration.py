"""The calibration of the Hilti construction robot, from the makers' files to the page.

    python make_calibration.py DATA_DIR OUT_DIR [--every N] [--jobs N] [--force]

writes OUT_DIR/records (see make_records.py), OUT_DIR/robot.toml, the model with `SIGMAS` added to its
uncertain values, and OUT_DIR/page, what `flexarm calibrate --family joint_compliance` writes: fitted to the
level floor, with the pallet held out. Prints the estimates, and the accelerometers on the column, which no
fit saw.
"""

from __future__ import annotations

import sys
from pathlib import Path

import make_records
from make_page import felt

import flexarm
from flexarm import Arm, Record
from flexarm.output import output_directory

sys.path.insert(0, str(Path(__file__).parents[1]))
from data_script import exit_code, page_command_line

AXES = range(1, 7)
"""Numbers of the arm's joints."""
SIGMAS = {
    "points.prism.position_m": 5e-3,
    **{f"effects.encoder_offset.dsr_joint{k}.offset_rad": 5e-3 for k in AXES},
    **{f"joints.dsr_joint{k}.origin.xyz_m": 2e-3 for k in AXES},
    **{f"joints.dsr_joint{k}.origin.rpy_rad": 3e-3 for k in AXES},
    "joints.column_to_dsr.origin.rpy_rad": 1e-2,
}
"""1 sigma of the arm's kinematics, of its mount and of the prism: our judgement [m], [rad]."""


def make_calibration(data: Path, out: Path, every: int, jobs: int | None, force: bool) -> None:
    """Records, model, page and accelerometers; all of it or nothing."""
    from flexarm.cli.progress import progress

    with output_directory(out, force) as directory:
        records, page = directory / "records", directory / "page"
        make_records.make_records(data, records, every)
        stated = Arm.from_toml(records / "robot.toml")
        arm = stated.replace(uncertainty={**stated.uncertainty, **SIGMAS})
        arm.to_toml(directory / "robot.toml")
        flat, pallet = (Record.load(records / floor) for floor in make_records.FILES)
        with progress() as tell:
            found = flexarm.calibrate(
                arm, {"flat": flat}, ["joint_compliance"], pallet, n_jobs=jobs, progress=tell
            )
        found.save(page)
        print(f"{found}\n\n{felt(records, page)}")
    print(f"\nwritten to {out}: open {out / 'page/report.html'}")


def main() -> int:
    """Command line; 0 if done, 2 if the input is at fault."""
    parser = page_command_line(
        "Calibration of the Hilti construction robot.", "flat.yaml, pallet.yaml and trailblazer.urdf"
    )
    parser.add_argument("--every", type=int, default=6, metavar="N", help="take one of N poses (default 6)")
    given = parser.parse_args()
    return exit_code(
        lambda: make_calibration(given.data, given.out, max(given.every, 1), given.jobs, given.force)
    )


if __name__ == "__main__":
    sys.exit(main())
