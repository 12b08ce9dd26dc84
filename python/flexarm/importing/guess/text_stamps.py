"""Stamps that are texts: date and time of day in one column or in several side by side."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime

import numpy as np

from flexarm.arrays import Floats

DATES = ("%m/%d/%Y", "%d/%m/%Y", "%d.%m.%Y", "%Y-%m-%d", "%Y/%m/%d")
TIMES = ("%H:%M:%S.%f", "%H:%M:%S,%f", "%H:%M:%S", "%I:%M:%S.%f %p", "%I:%M:%S %p")
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
    count = len(texts[0]) if texts else 0
    sample = np.linspace(0, count - 1, min(count, TRIED)).astype(int).tolist()
    for n in range(LONGEST, 0, -1):  # a time of day with its date rather than without
        for k in range(len(columns) - n + 1):
            run = texts[k : k + n]
            likely = _read([" ".join(text[row] for text in run) for row in sample], FORMS)
            rows = [" ".join(row) for row in zip(*run, strict=True)] if likely else []
            if found := _read(rows, list(likely)):
                dates = sorted({form.split(" ")[0] for form in found if "%Y" in form})
                what = f"which of {' and '.join(dates)} the date is" if len(dates) > 1 else ""
                form, seconds = next(iter(found.items()))
                return TextStamps(tuple(columns[k : k + n]), form, np.array(seconds), what)
    return None


def _read(rows: Sequence[str], forms: Sequence[str]) -> dict[str, list[float]]:
    """Return seconds by form, of the forms that all rows have; none if there is no row."""
    found = {}
    for form in forms if rows else ():
        with suppress(ValueError):
            found[form] = [_seconds(row, form) for row in rows]
    return found


def _seconds(text: str, form: str) -> float:
    instant = datetime.strptime(text, form)
    start = datetime(1900 if "%Y" not in form else 1970, 1, 1)
    return (instant - start).total_seconds()
