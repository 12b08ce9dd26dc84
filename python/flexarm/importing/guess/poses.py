"""Logs of poses, in whose rows the arm stands still: they are no instants of a motion.

Neighbouring rows of a motion are near one another, those of poses are not. Von Neumann's ratio of n rows,

    v = mean (x_{k+1} - x_k)^2 / var x,                                                                  (1)

is 2 for rows in no order, and near 0 for a motion that is sampled often enough [VonNeumann1941].
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from flexarm.arrays import Floats
from flexarm.importing.guess.logged import Logged, Stamped
from flexarm.importing.guess.words import is_stamp, words_of
from flexarm.units import factor_to

NUMBERS = (
    "pose",
    "poses",
    "point",
    "pt",
    "punkt",
    "nr",
    "no",
    "num",
    "number",
    "index",
    "idx",
    "id",
    "messung",
)
"""Words of columns that number poses."""


def as_poses(columns: Sequence[Logged]) -> list[Logged]:
    """Return the columns with numbers of poses in place of stamps, where rows are poses; else as they are."""
    tables: dict[str, list[Logged]] = {}
    for column in columns:
        tables.setdefault(column.file, []).append(column)
    numbers = {file: _numbers(table) for file, table in tables.items()}
    named = all(name is not None for name, _ in numbers.values())
    alike = named or len({len(column.values) for column in columns}) == 1
    plain = all(column.kind[1:] == (None, ()) for column in columns)
    if not (alike and plain and _jump(columns, numbers)) or any(map(_are_instants, columns)):
        return list(columns)
    found = []
    for column in columns:
        name, values = numbers[column.file]
        stamps = Stamped(None, None, values, 0.0, "", poses=True, pose=name if named else None)
        found += [] if named and column.column == name else [replace(column, time=stamps)]
    return found


def _jump(columns: Sequence[Logged], numbers: Mapping[str, tuple[str | None, Floats]]) -> bool:
    """Return True if an angle that moves is as far from one pose to the next as between any, by (1)."""
    in_order, moving = (
        0.5,
        0.1,
    )  # ratio (1) up to which rows follow one another; least deviation over the greatest
    angles = [column for column in columns if column.meaning.quantity == "joint_angle"]
    size = max((float(np.nanstd(column.values)) for column in angles), default=0.0)
    for column in (c for c in angles if np.nanstd(c.values) > moving * size):
        first = column.values[np.unique(numbers[column.file][1], return_index=True)[1]]
        x = first[np.isfinite(first)]
        if len(x) > 1 and np.mean(np.diff(x) ** 2) > in_order * np.var(x):
            return True
    return False


def _are_instants(column: Logged) -> bool:
    """Return True for stamps of a motion: dates or what is named so, less than two seconds apart."""
    slowest = 2.0  # interval of a log of a motion [s]
    time = column.time
    named = isinstance(time.column, tuple) or time.form is not None or time.of_calendar
    named = named or (isinstance(time.column, str) and is_stamp(time.column))
    return named and float(np.median(np.diff(time.seconds))) < slowest


def _numbers(table: Sequence[Logged]) -> tuple[str | None, Floats]:
    """Return the column of a file that numbers poses, by its name, and the numbers; else those of rows."""
    time, rounding = table[0].time, 1e-6
    stamps = (time.seconds + time.start) / (factor_to("s", time.unit or "s") or 1.0)
    for name, values in [(time.column, stamps), *((column.column, column.values) for column in table)]:
        whole = bool(np.abs(values - np.round(values)).max() < rounding)
        if isinstance(name, str) and whole and any(word in NUMBERS for word in words_of(name)):
            return name, np.round(values)
    return None, np.arange(float(len(table[0].values)))
