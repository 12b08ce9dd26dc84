"""Columns of logs with their values and stamps, as a guess looks at them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import InvalidFile
from flexarm.importing.formats import opened
from flexarm.importing.guess.text_stamps import TextStamps, text_stamps
from flexarm.importing.guess.words import COUNTED, Meaning, is_header_stamp, is_stamp, meaning_of, unit_in
from flexarm.importing.map_file import Dialect
from flexarm.importing.source import LOG, Array, Group, Request, Source, Unreadable
from flexarm.importing.stamps import CALENDAR
from flexarm.importing.time_unit import seconds_of
from flexarm.reading import reading
from flexarm.units import factor_to


@dataclass(frozen=True)
class Stamped:
    """Stamps of a table as a guess takes them."""

    column: str | int | tuple[str | int, ...] | None
    """As the map names them; several make a stamp together; None: there are none."""
    unit: str | None
    """Unit for the map; None: the source says it."""
    seconds: Floats
    """The stamps [s], from the first."""
    start: float
    """The first [s]."""
    why: str
    unknown: str = ""
    """The reason; what is not known."""
    form: str | None = None
    """Of stamps that are texts: how they read."""
    poses: bool = False
    """True if rows are poses, which `seconds` count."""
    pose: str | int | None = None
    """Column that numbers them."""

    @property
    def of_calendar(self) -> bool:
        """True if the stamps count from a date."""
        return self.start > CALENDAR


@dataclass(frozen=True)
class Logged:
    """One column of a log."""

    file: str
    """As the map names it."""
    topic: str | None
    column: str | int
    """As the map names it."""
    values: Floats
    time: Stamped
    meaning: Meaning
    """What it seems to be."""
    where: tuple[tuple[str, str], ...] = ()
    """Columns that label rows, and the labels of these, such as the name of a point; `*` for what differs."""
    texts: tuple[str, ...] = ()
    """The rows of a column that is no numbers; its values mean nothing."""
    told: str = ""
    """The only text of a column whose name has the same number, such as a joint's name."""

    @property
    def kind(self) -> tuple[str, str | None, tuple[tuple[str, str], ...]]:
        """File, topic and label: the columns that are read together."""
        return self.file, self.topic, self.where

    @property
    def label(self) -> str:
        """The labels of its rows; empty if there are none."""
        return " ".join(label for _, label in self.where)

    @property
    def rests(self) -> bool:
        """True if all its values are the same."""
        return bool(np.nanmax(self.values) == np.nanmin(self.values))


def logged(path: Path, named: str) -> list[Logged]:
    """Return the columns of numbers of a log.

    Raise InvalidFile if it cannot be read, or holds no numbers.
    """
    found: list[Logged] = []
    with reading(path, "a log"):
        source = opened(path, Dialect())
        groups = source.groups()
        shared = _shared_stamps(source, groups)
        for group in groups:
            found += _of_group(source, group, named, shared)
    if not found:
        raise InvalidFile(path, "file", "holds no columns of numbers")
    return found


def _of_group(source: Source, group: Group, named: str, shared: tuple[str, Array] | None) -> list[Logged]:
    columns = _columns(group)
    units = dict(zip(columns, group.units, strict=False))
    if group.time is not None and group.kind:  # messages: all fields at once
        samples = source.read(Request(group.topic, tuple(group.names), group.time))
        arrays: dict[str | int, Array] = dict(zip(group.names, samples.values.T, strict=True))
        stamps = _seconds(group.time, samples.time, samples.time_unit, "")
        return _rows(named, group, arrays, units, stamps, ())
    arrays, others = {}, []
    for column in columns:
        try:
            arrays[column] = source.read(Request(group.topic, (column,))).values[:, 0]
            instants = source.array(group.topic, source.find(group.topic, column, "columns")[0])
            others += [column] if instants.dtype.kind in "mM" else []
        except Unreadable:
            others.append(column)
    texts = _texts(source, group, others)
    stamped = text_stamps(list(texts), list(texts.values()))
    arrays = {c: values for c, values in arrays.items() if stamped is None or c not in stamped.columns}
    labels = _labels({c: rows for c, rows in texts.items() if stamped is None or c not in stamped.columns})
    if labels and any(_meaning(group, c, units.get(c, "")).quantity == "joint_angle" for c in arrays):
        whole = _stamps(source, group, arrays, None, stamped, slice(None))
        labels = labels if whole.column is None or whole.unknown else {}  # states of one motion
    if not labels:
        stamps = _stamps(source, group, arrays, shared, stamped, slice(None))
        single = {n: rows[0] for c, rows in texts.items() if len(set(rows)) == 1 and (n := _number(c))}
        found = [
            replace(column, told=single.get(_number(column.column), ""))
            for column in _rows(named, group, arrays, units, stamps, ())
        ]
        return found + [
            replace(found[0], column=column, meaning=meaning_of(""), texts=tuple(rows))
            for column, rows in texts.items()
            if found and len(rows) == len(stamps.seconds) and all(rows)
        ]
    rows: list[Logged] = []
    each = list(zip(*labels.values(), strict=True))
    for label in dict.fromkeys(each):
        chosen = np.array([k for k, found in enumerate(each) if found == label])
        here = {name: values[chosen] for name, values in arrays.items()}
        stamps = _stamps(source, group, here, None, stamped, chosen)
        where = tuple(zip(map(str, labels), label, strict=True))
        rows += _rows(named, group, here, units, stamps, where)
    return rows


def _number(column: str | int) -> str:
    """Return the only number in a column's name; empty if there is none."""
    numbers = re.findall(r"\d+", column) if isinstance(column, str) else []
    return numbers[0] if len(numbers) == 1 else ""


def _texts(source: Source, group: Group, columns: Sequence[str | int]) -> dict[str | int, list[str]]:
    """Return columns that are no numbers as texts; instants as they stand in the file."""
    requests = [Request(group.topic, (c,), c, stamps_are_text=True) for c in columns]
    again = type(source)(source.path, source.dialect, requests)
    found: dict[str | int, list[str]] = {}
    for column in columns:
        array = again.array(group.topic, again.find(group.topic, column, "columns")[0])
        if array.ndim == 1 and array.dtype.kind in "OU":
            found[column] = [str(value).strip() for value in array.tolist()]
    return found


def _labels(texts: Mapping[str | int, list[str]]) -> dict[str | int, list[str]]:
    """Return the columns that tell few kinds of rows apart; numbers at the end of many names become `*`.

    Texts with few rows each name these, as those of poses do.
    """
    most_labels = 20  # different texts of a column that labels rows, such as the names of points
    few_rows = 8
    found = {}
    for column, rows in texts.items():
        many = len(set(rows)) > most_labels
        labels = [re.sub(r"\d+$", "*", row) for row in rows] if many else rows
        if 1 < len(set(labels)) <= most_labels and len(rows) > few_rows * len(set(labels)):
            found[column] = labels
    return found if len(set(zip(*found.values(), strict=True))) <= most_labels else {}


def _rows(
    named: str,
    group: Group,
    arrays: dict[str | int, Array],
    units: dict[str | int, str],
    stamps: Stamped,
    where: tuple[tuple[str, str], ...],
) -> list[Logged]:
    most = 1e60  # what is beyond is damage, a drop-out here; squares of less do not overflow
    sound = {name: np.where(np.abs(values) <= most, values, np.nan) for name, values in arrays.items()}
    return [
        Logged(named, group.topic, column, values, stamps, counted(meaning, values), where)
        for column, values in sound.items()
        if column != stamps.column and len(values) == len(stamps.seconds) and np.isfinite(values).any()
        for meaning in [_meaning(group, column, units.get(column, ""))]
    ]


def counted(meaning: Meaning, values: Floats) -> Meaning:
    """Return the meaning of whole numbers of an angle without a unit: counts, as degrees are never all whole.

    Few values may be whole by chance.
    """
    few = 20
    whole = values[np.isfinite(values)]
    bare = meaning.quantity == "joint_angle" and not meaning.unit
    if not bare or np.any(whole != np.round(whole)) or len(np.unique(whole)) < few:
        return meaning
    return replace(meaning, unit=COUNTED, why=f"{meaning.why}; whole numbers")


def _columns(group: Group) -> list[str | int]:
    """Return columns as a map names them: by number where the name is missing or stands there twice."""
    names = list(group.names)
    return [
        name if name and names.count(name) == 1 and name != "" else number
        for number, name in enumerate(names, 1)
    ]


def _meaning(group: Group, column: str | int, unit: str) -> Meaning:
    name = column if isinstance(column, str) else ""
    inside = group.topic.rpartition("/")[2] if group.topic and not group.kind else ""
    found = meaning_of(name, unit, group.kind)
    if not found.quantity and inside:
        found = meaning_of(f"{inside}_{name}", unit, group.kind)
    return found


def _shared_stamps(source: Source, groups: Sequence[Group]) -> tuple[str, Array] | None:
    """Return path and values of the only stamps of a tree of arrays, which its other groups share."""
    found = []
    for group in groups:
        for name in group.names:
            if is_stamp(name) and group.topic is not None and not group.kind and group.time is None:
                with suppress(Unreadable):
                    values = source.read(Request(group.topic, (name,))).values[:, 0]
                    separator = getattr(source, "separator", "")
                    if separator and np.all(np.diff(values) > 0):
                        found.append((f"{group.topic}{separator}{name}", values))
    return found[0] if len(found) == 1 else None


def _stamps(
    source: Source,
    group: Group,
    arrays: dict[str | int, Array],
    shared: tuple[str, Array] | None,
    texts: TextStamps | None,
    rows: Array | slice,
) -> Stamped:
    if texts is not None and (np.diff(texts.seconds[rows]) > 0).all():
        columns = texts.columns if len(texts.columns) > 1 else texts.columns[0]
        found = _seconds(columns, texts.seconds[rows], "s", "", "its texts read as dates and times")
        return replace(found, unit=None, form=texts.form, unknown=texts.unknown)
    rising = [c for c, v in arrays.items() if len(v) > 1 and np.isfinite(v).all() and (np.diff(v) > 0).all()]
    rising.sort(key=lambda c: bool((np.diff(arrays[c]) == 1).all()))  # numbers of rows come last
    by_name = [column for column in rising if isinstance(column, str) and is_stamp(column)]
    if by_name or (rising and group.time is None and shared is None):
        column = (sorted(by_name, key=lambda name: not is_header_stamp(name)) or rising)[0]
        request = Request(group.topic, (column,), column)
        samples = source.read(request)
        said = dict(zip(_columns(group), group.units, strict=False)).get(column, "")
        hint = unit_in(str(column), said)
        why = "its name" if by_name else "the first column that rises throughout and does not number rows"
        assert samples.time is not None
        unknown = "" if by_name else "whether these are the stamps"
        return _seconds(column, samples.time[rows], samples.time_unit, hint, why, unknown)
    if group.time == LOG:
        with suppress(Unreadable):
            time, unit = source.log_time(group.topic, [0])
            return _seconds(LOG, time, unit, "", "the time that the file itself gives")
    if shared is not None:
        return _seconds(shared[0], shared[1], None, unit_in(shared[0]), "the only stamps of the file")
    count = max((len(values) for values in arrays.values()), default=0)
    return Stamped(None, None, np.arange(count, dtype=float), 0.0, "", "stamps: no column rises throughout")


def _seconds(
    column: str | int | tuple[str | int, ...],
    raw: Array | None,
    said: str | None,
    hint: str,
    why: str = "",
    unknown: str = "",
) -> Stamped:
    """Return stamps with their unit: as the source or the name says it, else by their size and interval."""
    time = np.array([]) if raw is None else np.asarray(raw, dtype=float)
    known, named = seconds_of(said or ""), factor_to("s", hint)
    unit: str | None = hint
    reason = "its name says the unit"
    if named is None or known not in (None, named):
        unit, reason = None, "the source says its unit"
    if unit is None and known is None:
        unit, reason = _unit_by_size(time)
        unknown = unknown or "" if reason else "unit of the stamps"
    seconds = time * (known or factor_to("s", unit or "s") or 1.0)
    steps = np.diff(np.unique(seconds))  # messages of several senders may share their stamps
    rate = 1 / float(np.median(steps)) if len(steps) else 0.0
    told = "; ".join(part for part in (why, reason, f"{rate:.4g} Hz") if part)
    start = float(seconds[0]) if len(seconds) else 0.0
    return Stamped(column, unit, seconds - start, start, told, unknown)


def _unit_by_size(time: Floats) -> tuple[str, str]:
    """Return a unit and why; without a reason where several fit."""
    usual_interval = (1e-5, 2.0)  # intervals at which logs are sampled [s], from 0.5 Hz to 100 kHz
    interval = float(np.median(np.diff(time))) if len(time) > 1 else 0.0
    for unit, factor in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)):
        if CALENDAR < time[:1].sum() * factor < 1e2 * CALENDAR:
            return unit, f"as {unit} it counts from 1970"
    fitting = [
        unit
        for unit, factor in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9))
        if usual_interval[0] <= interval * factor <= usual_interval[1]
    ]
    whole = bool(np.all(time == np.round(time)))
    if "s" in fitting and not whole:
        return "s", "decimals at an interval of a sensor"
    if whole and fitting and "s" not in fitting:
        return fitting[0], f"whole numbers at an interval of {interval:g}"
    return (fitting[-1] if whole and fitting else "s"), ""
