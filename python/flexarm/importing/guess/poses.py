"""Logs of poses, in whose rows the arm stands still: they are no instants of a motion.

Neighbouring rows of a motion are near one another, those of poses are not. Von Neumann's ratio of n rows,

    v = mean (x_{k+1} - x_k)^2 / var x,                                                                  (1)

is 2 for rows in no order, and near 0 for a motion that is sampled often enough [VonNeumann1941].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from flexarm.importing.guess.logged import Logged
from flexarm.importing.guess.words import is_stamp, words_of

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
    """Return the columns with rows in place of stamps, where these are poses; else as they are."""
    angles = [column for column in columns if column.meaning.quantity == "joint_angle"]
    rows = {len(column.values) for column in columns}
    if not angles or len(rows) != 1 or any(column.kind[1:] != (None, ()) for column in columns):
        return list(columns)
    if not _jump(angles) or any(_are_instants(column) for column in columns):
        return list(columns)
    numbers = {file: _number(columns, file) for file in {column.file for column in columns}}
    named = None not in numbers.values()
    return [
        replace(
            column,
            time=replace(
                column.time,
                column=None,
                unit=None,
                seconds=np.arange(float(*rows)),
                start=0.0,
                form=None,
                unknown="",
                poses=True,
                pose=numbers[column.file] if named else None,
            ),
        )
        for column in columns
        if not (named and column.column == numbers[column.file])
    ]


def _jump(angles: Sequence[Logged]) -> bool:
    """Return True if neighbouring values of an angle are as far apart as any, by (1)."""
    in_order = 0.5  # ratio (1) up to which rows follow one another
    finite = (column.values[np.isfinite(column.values)] for column in angles if not column.rests)
    return any(np.mean(np.diff(x) ** 2) > in_order * np.var(x) for x in finite if len(x) > 1)


def _are_instants(column: Logged) -> bool:
    """Return True for stamps of a motion: dates or what is named so, less than two seconds apart."""
    slowest = 2.0  # interval of a log of a motion [s]
    time = column.time
    named = isinstance(time.column, tuple) or time.form is not None or time.of_calendar
    named = named or (isinstance(time.column, str) and is_stamp(time.column))
    return named and float(np.median(np.diff(time.seconds))) < slowest


def _number(columns: Sequence[Logged], file: str) -> str | int | None:
    """Return the column of a file that numbers its poses, by its name."""
    here = [column for column in columns if column.file == file]
    names = [here[0].time.column, *(column.column for column in here if _is_whole(column))]
    return next((n for n in names if isinstance(n, str) and any(w in NUMBERS for w in words_of(n))), None)


def _is_whole(column: Logged) -> bool:
    return bool(np.all(column.values == np.round(column.values)))
