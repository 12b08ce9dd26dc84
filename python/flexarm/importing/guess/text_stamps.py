"""Stamps that are texts: date and time of day in one column or in two side by side."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from itertools import pairwise

import numpy as np

from flexarm.arrays import Floats

DATES = ("%m/%d/%Y", "%d/%m/%Y", "%d.%m.%Y", "%Y-%m-%d", "%Y/%m/%d")
TIMES = ("%H:%M:%S.%f", "%H:%M:%S", "%I:%M:%S.%f %p", "%I:%M:%S %p")
FORMS = (*(f"{date} {time}" for date in DATES for time in TIMES), *TIMES)
"""Forms of stamps, those with a date first; month before day, as SpatialAnalyzer writes them, goes first."""


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
    """Return the first column, or two in a row, whose texts are stamps; None if none are."""
    found = [
        *(((one,), rows) for one, rows in zip(columns, texts, strict=True)),
        *(
            (pair, [f"{a} {b}" for a, b in zip(first, second, strict=True)])
            for pair, (first, second) in zip(pairwise(columns), pairwise(texts), strict=True)
        ),
    ]
    found.sort(key=lambda each: -len(each[0]))  # a time of day with its date rather than without
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
    tried = 50  # stamps that must have a form, spread over the rows, before all are read
    sample = [rows[k] for k in np.linspace(0, len(rows) - 1, tried).astype(int)] if len(rows) else [""]
    with suppress(ValueError):
        for row in (*sample, *rows):
            _seconds(row, form)
        return True
    return False


def _seconds(text: str, form: str) -> float:
    instant = datetime.strptime(text, form)
    start = datetime(1900 if "%Y" not in form else 1970, 1, 1)
    return (instant - start).total_seconds()
