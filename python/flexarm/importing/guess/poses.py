"""Logs of poses, in whose rows the arm stands still: they are no instants of a motion.

Neighbouring rows of a motion are near one another, those of poses are not. Von Neumann's ratio of n rows,

    v = mean (x_{k+1} - x_k)^2 / var x,                                                                  (1)

is 2 for rows in no order, and near 0 for a motion that is sampled often enough [VonNeumann1941].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from flexarm.arrays import Ints
from flexarm.importing.guess.logged import Logged, Stamped
from flexarm.importing.guess.words import is_stamp, words_of
from flexarm.record.signal import canonical_pose
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
    "name",
    "target",
    "station",
    "stand",
)
"""Words of columns that name or number poses."""


def as_poses(columns: Sequence[Logged]) -> list[Logged]:
    """Return the columns of numbers, with rows in place of stamps where these are poses.

    Where all tables name their poses, rows go in the order in which the angles name them first. Such rows
    are poses in any order, if there are no stamps.
    """
    numbers = [column for column in columns if not column.texts]
    angles = [column for column in numbers if column.meaning.quantity == "joint_angle"]
    if not angles or any(column.where for column in columns) or any(map(_are_instants, numbers)):
        return numbers
    tables = dict.fromkeys([angles[0].kind, *(column.kind for column in numbers)])
    names = {kind: found for kind in tables if (found := _names([c for c in columns if c.kind == kind]))}
    if len(names) < len(tables):
        names = {}
    order = {pose: k for k, pose in enumerate(dict.fromkeys(p for _, poses in names.values() for p in poses))}
    rows = {kind: np.array([order[pose] for pose in poses]) for kind, (_, poses) in names.items()}
    if not names and len({len(column.values) for column in numbers}) == 1:
        rows = {kind: np.arange(len(angles[0].values)) for kind in tables}
    stamped = not names or any(column.time.column is not None for column in numbers)
    moving = 0.1  # least deviation of an angle that moves, over the greatest
    size = max(np.nanstd(column.values) for column in angles)
    moved = [column for column in angles if np.nanstd(column.values) > moving * size]
    if not rows or (stamped and not any(_jumps(column, rows[column.kind]) for column in moved)):
        return numbers
    return [
        replace(
            column,
            values=column.values[turn],
            time=Stamped(
                None, None, rows[column.kind][turn].astype(float), 0.0, column.time.why, poses=True, pose=pose
            ),
        )
        for column in numbers
        for turn in [np.argsort(rows[column.kind], kind="stable")]
        for pose in [names[column.kind][0] if names else None]
        if column.column != pose
    ]


def _jumps(angle: Logged, rows: Ints) -> bool:
    """Return True if values of an angle in neighbouring poses are as far apart as any, by (1)."""
    in_order = 0.5  # ratio (1) up to which rows follow one another
    x = angle.values[np.unique(rows, return_index=True)[1]]
    x = x[np.isfinite(x)]
    return len(x) > 1 and bool(np.mean(np.diff(x) ** 2) > in_order * np.var(x) > 0)


def _are_instants(column: Logged) -> bool:
    """Return True for stamps of a motion: dates or what is named so, less than two seconds apart."""
    slowest = 2.0  # interval of a log of a motion [s]
    time = column.time
    named = isinstance(time.column, tuple) or time.form is not None or time.of_calendar
    named = named or (isinstance(time.column, str) and is_stamp(time.column))
    return named and float(np.median(np.diff(time.seconds))) < slowest


def _names(table: Sequence[Logged]) -> tuple[str, list[str]] | None:
    """Return the column of a table that names or numbers its poses, by its name, and the pose of each row."""
    time = table[0].time
    stamps = (time.start + time.seconds) / (factor_to("s", time.unit or "s") or 1.0)
    found: list[tuple[str | int, Any]] = [(c.column, c.texts) for c in table if c.texts]
    found += [(time.column, np.round(stamps, 9))] if isinstance(time.column, str) else []
    found += [(c.column, c.values) for c in table if _is_whole(c)]
    return next(
        (
            (name, [canonical_pose(str(pose)) for pose in poses])
            for name, poses in found
            if isinstance(name, str) and any(word in NUMBERS for word in words_of(name))
        ),
        None,
    )


def _is_whole(column: Logged) -> bool:
    return not column.texts and bool(np.all(column.values == np.round(column.values)))
