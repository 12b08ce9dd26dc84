"""A drive as a CSV file: `time_s` and a column of exact samples for each driven joint."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import InvalidFile
from flexarm.record.columns import CsvFile
from flexarm.tables.ranges import first_beyond, out_of_range, range_of

if TYPE_CHECKING:
    from flexarm.arm import Arm


def samples_in(path: str | Path, arm: Arm) -> tuple[Floats, dict[str, Floats]]:
    """Return times [s] and samples by joint.

    Raises
    ------
    InvalidFile
        With line and column of what is wrong.
    """
    table = CsvFile(Path(path), path)
    if "time_s" not in table.header:
        raise InvalidFile(path, "header", f"has no column time_s; there are {', '.join(table.header)}")
    moving = [joint.name for joint in arm.moving_joints]
    names = [name for name in table.header if name != "time_s"]
    for name in names:
        if name not in moving:
            raise InvalidFile(
                path, f"column {name}", f"is no moving joint of the model; there are {', '.join(moving)}"
            )
    if not names:
        raise InvalidFile(path, "header", f"drives no joint; add a column named {' or '.join(moving)}")
    rows = table.numbers(["time_s", *names])
    if len(rows) < 2:
        raise InvalidFile(path, "file", f"needs at least two rows of numbers, got {len(rows)}")
    wrong = np.argwhere(~np.isfinite(rows))
    if len(wrong):
        row, column = wrong[0]
        where = f"line {table.line(int(row))}, column {['time_s', *names][column]}"
        raise InvalidFile(path, where, "must be a finite number; a drive has no drop-outs")
    units = ["s", *("m" if arm.joint(name).type == "prismatic" else "rad" for name in names)]
    for name, column, unit in zip(["time_s", *names], rows.T, units, strict=True):
        if at := first_beyond(column, unit):
            what = str(out_of_range(float(column[at]), unit, size=False))
            raise InvalidFile(path, f"line {table.line(at[0])}, column {name}", what)
    time = rows[:, 0]
    backward = np.flatnonzero(np.diff(time) < range_of("s")[0])
    if len(backward):
        k = int(backward[0]) + 1
        where = f"line {table.line(k)}, column time_s"
        raise InvalidFile(path, where, f"times must rise, got {time[k]:g} s after {time[k - 1]:g} s")
    return time, {name: rows[:, i] for i, name in enumerate(names, 1)}
