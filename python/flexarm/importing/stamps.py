"""From the stamps of logs to seconds: units, texts, and clocks that count from 1970.

Whole numbers of nanoseconds since 1970 do not fit into a double to better than 0.2 us. So an origin, a whole
second, is taken off before they are divided: the same one for all clocks that are known against each other.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from math import floor
from typing import Any

import numpy as np

from flexarm.arrays import Floats
from flexarm.importing.map_file import Every, SignalMap
from flexarm.importing.source import Array, Samples, Unreadable
from flexarm.importing.time_unit import seconds_of
from flexarm.record.table import Clock
from flexarm.tables.ranges import range_of
from flexarm.units import factor_to, si_factor

CALENDAR = 1e8
"""Stamps beyond [s], three years, are of a clock that counts from a date, not from its start."""


@dataclass(frozen=True)
class Stamps:
    """Stamps of a signal as they stand, and the factor to seconds."""

    raw: Array
    factor: float

    @property
    def start(self) -> float:
        """The first stamp [s]; 0 if there is none."""
        return float(self.raw[0]) * self.factor if len(self.raw) else 0.0

    @property
    def of_calendar(self) -> bool:
        """True if they count from a date."""
        return self.start > CALENDAR

    def seconds(self, origin: int) -> Floats:
        """Return the stamps [s] after an origin, a whole second; whole numbers lose nothing."""
        if self.raw.dtype.kind in "iu":
            shift = round(origin / self.factor)
            return np.asarray((self.raw.astype(np.int64) - shift) * self.factor, dtype=float)
        if self.factor == 1 and origin == 0:
            return self.raw
        return np.asarray(self.raw * self.factor - origin, dtype=float)


def stamps_of(table: SignalMap, samples: Samples, place: Callable[[int], str]) -> Stamps:
    """Return the stamps of a signal; they must rise.

    Raise Unreadable with the place of what is wrong.
    """
    if isinstance(table.time, Every):
        rows = np.arange(len(samples.values))
        return Stamps(rows / table.time.rate_hz + table.time.start, 1.0)
    assert samples.time is not None
    raw, said = samples.time, samples.time_unit
    if table.time_format is not None:
        raw, said = _parsed(raw, table.time_format, place), "us"
    if raw.dtype.kind not in "iuf":
        what = f"stamps are texts such as {str(raw[0])[:40]!r}; time_format says how they are written"
        raise Unreadable("time", what)
    factor = _factor(table.time_unit, said)
    _check(raw, factor, place)
    return Stamps(raw, factor)


def _factor(stated: str | None, said: str | None) -> float:
    """Return the seconds of the unit that the map states or the source says; without either they are s."""
    seconds = seconds_of(said or "")
    if stated is None:
        if said and seconds is None and factor_to("1", said) is None:
            raise Unreadable("time_unit", f"is missing; the unit {said!r} of the source is none of time")
        return 1.0 if seconds is None else seconds
    factor = si_factor(stated, ("s",))[1]
    if seconds not in (None, factor):
        raise Unreadable("time_unit", f"is {stated!r}, but the source says {said!r}")
    return factor


def _parsed(texts: Array, form: str, place: Callable[[int], str]) -> Array:
    """Return microseconds since 1970, or since midnight where the form has no date."""
    found = np.empty(len(texts), dtype=np.int64)
    start = datetime(1970, 1, 1, tzinfo=UTC)
    for row, text in enumerate(texts.tolist()):
        try:
            instant = datetime.strptime(str(text).strip(), form)
        except ValueError:
            what = f"{place(row)}: {str(text)[:40]!r} is not of the form {form!r}"
            raise Unreadable("time_format", what) from None
        instant = instant if instant.tzinfo else instant.replace(tzinfo=UTC)
        instant = instant.replace(year=1970) if instant.year == 1900 else instant
        found[row] = (instant - start) // timedelta(microseconds=1)
    return found


def _check(raw: Array, factor: float, place: Callable[[int], str]) -> None:
    if raw.dtype.kind == "f" and not np.isfinite(raw).all():
        row = int(np.flatnonzero(~np.isfinite(raw))[0])
        raise Unreadable("time", f"{place(row)}: a row needs a time, got {raw[row]:g}")
    falls = np.flatnonzero(np.diff(raw) < range_of("s")[0] / factor)
    if raw.dtype.kind == "u":
        falls = np.flatnonzero(raw[1:] <= raw[:-1])
    if len(falls):
        row = int(falls[0]) + 1
        kind = "repeats" if raw[row] == raw[row - 1] else "goes back behind"
        more = f", and {len(falls) - 1} more" if len(falls) > 1 else ""
        what = f"{_number(raw[row])} {kind} {_number(raw[row - 1])} of {place(row - 1)}{more}"
        raise Unreadable("time", f"{place(row)}: {what}; times must rise")


def _number(value: Any) -> str:
    return f"{value:.15g}" if isinstance(value, float) else str(value)


def origins(stamps: Mapping[str, list[Stamps]], clocks: Mapping[str, Clock]) -> dict[str, int]:
    """Return for each clock the whole second from which its stamps shall count; 0: as they stand.

    An unknown clock has an origin of its own where it counts from another date.
    """
    start = {name: min((each.start for each in found), default=0.0) for name, found in stamps.items()}
    known = [start[name] for name, clock in clocks.items() if name in start and not clock.unknown]
    common = floor(min(known)) if known and min(known) > CALENDAR else 0
    found = {}
    for name, first in start.items():
        alike = not clocks[name].unknown or (common and abs(first - common) < CALENDAR)
        found[name] = common if alike else floor(first) if first > CALENDAR else 0
    return found


def as_date(origin: int) -> str:
    """Return a second since 1970 as a date."""
    try:
        return datetime.fromtimestamp(origin, UTC).strftime("%Y-%m-%d %H:%M:%S UTC")
    except (OverflowError, OSError, ValueError):
        return f"{origin} s"
