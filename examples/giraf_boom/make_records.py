"""Records from the files of the GIRAF boom.

    python make_records.py DATA_DIR OUT_DIR

reads `static.csv` and, where they are, `ringdown_*.csv` of DATA_DIR, and writes

    OUT_DIR/boom.toml, boom_with_hand.toml, ringdown.toml   of this folder
    OUT_DIR/static_MMMM                 poses at one length, MMMM millimetres, one for each pull at the tip
    OUT_DIR/ringdown_MMMM               a step of the pitch at one length: see ring_downs.py

How the columns of static.csv become signals (SI; the boom lies along x, z is up):

    extension           length of the boom in the record's [links]: from the outlet to the tip
    applied force       force at `tip`, downward: -z of the base
    endpoint height     position of `tip` along z, in a frame whose zero lies 375 mm below the boom's outlet
    deflection          not used: it is 375 mm less the height

The boom is straight and level at 375 mm by that last column, and the frame takes that as exact: a tilt of the
base then shows. Heights are read to 1 mm: 1 sigma is 1 mm/sqrt(12).
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexarm import InvalidFile, Record, Signal
from flexarm.output import output_directory
from flexarm.record import DrawnLink, Frame

sys.path.insert(0, str(Path(__file__).parents[1]))
from data_script import check_folder, command_line, exit_code, read_numbers
from ring_downs import length_of, ring_down_record

Rows = NDArray[np.float64]

HEADINGS = ("Boom Extension (mm)", "Applied Force (N)", "Endpoint Height (mm)", "Deflection (mm)")
MODELS = ("boom.toml", "boom_with_hand.toml", "ringdown.toml")
LEVEL = 0.375
"""Height of a level boom [m]."""
READING = 1e-3
"""Step of the readings of height [m]."""


def read_static(path: Path) -> Rows:
    """Extension [m], force [N], height [m] of every row.

    Raises
    ------
    InvalidFile
        With the line of what is wrong.
    """
    extension, force, height, deflection = read_numbers(path, HEADINGS).T
    wrong = np.flatnonzero(np.abs(height + deflection - 1e3 * LEVEL) > 1e-9)
    if len(wrong):
        raise InvalidFile(
            path,
            f"line {wrong[0] + 2}",
            f"height and deflection must add up to {1e3 * LEVEL:g} mm, got "
            f"{height[wrong[0]] + deflection[wrong[0]]:g} mm",
        )
    return np.stack([1e-3 * extension, force, 1e-3 * height], axis=1)


def static_record(rows: Rows, length: float) -> Record:
    """The poses at one length: a pull at the tip, and the height that it leaves."""
    _, force, height = rows[rows[:, 0] == length].T
    pose = np.array([f"{pull:g} N" for pull in force])
    signals = [
        Signal(name="pull", quantity="force", point="tip", axes=("z",), values=-force[:, None], pose=pose,
               file="static.csv"),
        Signal(name="tip", quantity="position", point="tip", axes=("z",), values=height[:, None], pose=pose,
               file="static.csv", frame="floor", noise_std=READING / np.sqrt(12)),
    ]  # fmt: skip
    return Record(
        kind="static",
        signals=signals,
        description=f"GIRAF boom, {1e3 * length:g} mm out, pulled down at its tip",
        links={"boom": DrawnLink(length=length)},
        frames={"floor": Frame(xyz=(0.0, 0.0, -LEVEL))},
    )


def make_records(data: Path, out: Path, force: bool = False) -> list[Path]:
    """Writes model and records; returns the records' folders."""
    check_folder(data, "static.csv")
    rows = read_static(data / "static.csv")
    found = []
    with output_directory(out, force) as directory:
        for model in MODELS:
            shutil.copy(Path(__file__).with_name(model), directory / model)
        for length in np.unique(rows[:, 0]):
            name = f"static_{1e3 * length:04.0f}"
            static_record(rows, float(length)).save(directory / name)
            found.append(out / name)
        for path in sorted(data.glob("ringdown_*.csv"), key=length_of):
            name = f"ringdown_{1e3 * length_of(path):04.0f}"
            ring_down_record(path).save(directory / name)
            found.append(out / name)
    return found


def main() -> int:
    """Command line; 0 if done, 2 if the input is at fault."""
    given = command_line("Records of the GIRAF boom.", "static.csv", force=True).parse_args()
    return exit_code(lambda: print(*make_records(given.data, given.out, given.force), sep="\n"))


if __name__ == "__main__":
    sys.exit(main())
