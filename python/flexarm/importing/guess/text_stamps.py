"""Stamps that are texts: date and time of day in one column or in several side by side."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime

import numpy as np

from flexarm.arrays import Floats

DATES = ("%m/%d/%Y", "%d/%m/%Y", "%d.%m.%Y", "%Y-%m-%d", "%Y/%m/%d")
TIMES = ("%H:%M:%S.%f", "%H:%M:%S", "%I:%M:%S.%f %p", "%I:%M:%S %p")
FORMS = (*(f"{date} {time}" for date in DATES for time in TIMES), *TIMES)
"""Forms of stamps, those with a date first; month before day, as SpatialAnalyzer writes them, goes first."""
LONGEST = 3
"""Columns that make a stamp together at most: date, time of day, and half of the day."""
TRIED = 50
"""Stamps that must have a form, spread over the rows, before all are read."""


@dataclass(frozen=True)
class TextStamps:
    """Columns of texts that make stamps together, and how they read."""

    columns: tuple[str | int, ...]
    form: str
    seconds: Floats
    """Since 1970, or since midnight where the form has no date [s]."""
    unknown: str
    """What the texts do not tell; empty if nothing."""


def text_stamps(columns: Sequence[str | int], texts: Sequence[Sequence[str]]) -> TextStamps | None:
    """Return the first columns in a row whose texts are stamps together; None if none are."""
    runs = [(k, n) for n in range(LONGEST, 0, -1) for k in range(len(columns) - n + 1)]  # with its date first
    found = [
        (tuple(columns[k : k + n]), [" ".join(row) for row in zip(*texts[k : k + n], strict=True)])
        for k, n in runs
    ]
    for named, rows in found:
        forms = [form for form in FORMS if _reads(rows, form)]
        if forms:
            seconds = np.array([_seconds(row, forms[0]) for row in rows])
            dates = {form.split(" ")[0] for form in forms if "%Y" in form}
            what = f"which of {' and '.join(sorted(dates))} the date is" if len(dates) > 1 else ""
            return TextStamps(named, forms[0], seconds, what)
    return None


def _reads(rows: Sequence[str], form: str) -> bool:
    """Return True if all rows have a form; a sample of them is looked at first."""
    sample = [rows[k] for k in np.linspace(0, len(rows) - 1, TRIED).astype(int)] if len(rows) else [""]
    with suppress(ValueError):
        for row in (*sample, *rows):
            _seconds(row, form)
        return True
    return False


def _seconds(text: str, form: str) -> float:
    instant = datetime.strptime(text, form)
    start = datetime(1900 if "%Y" not in form else 1970, 1, 1)
    return (instant - start).total_seconds()
