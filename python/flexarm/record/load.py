"""From a directory to a record, in SI units."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexarm.arm.consistency import missing
from flexarm.arrays import Floats
from flexarm.errors import InvalidFile, Problem
from flexarm.foreign_files import foreign_kind
from flexarm.reading import OUTSIDE, is_inside, reading
from flexarm.record.columns import CsvFile
from flexarm.record.consistency import STAMPS, is_input, response_unit
from flexarm.record.file_table import RecordTable, SignalTable
from flexarm.record.signal import Signal, canonical_pose
from flexarm.record.table import Clock
from flexarm.tables import check_table, read_toml
from flexarm.tables.place import line_in
from flexarm.tables.ranges import first_beyond, range_of
from flexarm.units import contradicted_unit, si_factor


def stored(path: Path, allow_outside: bool = False) -> dict[str, Any]:
    """Return the attributes of the record in a directory, or beside the `record.toml` that `path` names."""
    toml = path / "record.toml" if path.is_dir() else path
    if path.is_dir() and not _exists(toml) and (kind := foreign_kind(path)):
        raise InvalidFile(path, "record", kind)
    if not _exists(toml) and toml.name != "record.toml":
        what = "there is no such directory; a record is a directory with record.toml"
        raise InvalidFile(path, "record", what)
    data, text = read_toml(toml, "flexarm-record/1")
    table = check_table(RecordTable, data, toml, text)
    reader = _Reader(toml, table, text, allow_outside or OUTSIDE.get())
    clocks = dict(table.clocks) or {"clock": Clock()}
    with reading(toml, "a record"):
        signals = [reader.signal(i, signal, next(iter(clocks))) for i, signal in enumerate(table.signals)]
    return {
        **table.stated(),
        "signals": {signal.name: signal for signal in signals},
        "clocks": clocks,
        "path": toml.parent,
        "notes": tuple(reader.notes),
    }


class _Reader:
    """Reads the signals of one record; those that share a file share the read."""

    def __init__(self, toml: Path, table: RecordTable, text: str, outside: bool) -> None:
        self.toml, self.table, self.text, self.outside = toml, table, text, outside
        self.notes: list[Problem] = []
        self._files: dict[str, CsvFile] = {}
        self._columns: dict[str, dict[str, Floats]] = {}
        self._times: dict[tuple[str, str, str], Floats] = {}

    def signal(self, i: int, table: SignalTable, reference: str) -> Signal:
        """Return one signal in SI units."""
        if is_input(self.table, table):
            channels = table.spec.channels or len(table.axes)
            return Signal(
                name=table.name,
                quantity=table.quantity,
                values=np.empty((0, channels)),
                unit=table.si[0],
                frequency=np.empty(0),
                clock=table.clock or reference,
                **table.located,
            )
        self._check_columns(i, table)
        unit, factor = self._unit(table)
        for column in table.channels:
            self._check_range(table.file, column, "Pa" if table.areas else unit, factor)
        values = np.stack([self._column(table.file, name) for name in table.channels], axis=1) * factor
        if table.areas:
            acting = np.array(table.areas) * [1, -1][: len(table.areas)]
            values, factor = values @ acting[:, None], factor * float(np.linalg.norm(acting))
        stamp = STAMPS[self.table.kind]
        if table.spec.has_side and "side" not in table.model_fields_set:
            self.notes.append(Problem(f"signals.{table.name}.side", 'is not given, taken as "motor"'))
        self._compare_suffix(table)
        return Signal(
            name=table.name,
            quantity=table.quantity,
            values=values,
            unit=unit,
            unit_assumed=table.unit is None,
            time=self._time(table) if stamp == "time" else np.array([]),
            pose=self._pose(table) if stamp == "pose" else None,
            frequency=self._frequency(table) if stamp == "frequency" else None,
            input=table.input or "",
            coherence=None if table.coherence is None else self._column(table.file, table.coherence),
            averages=table.averages,
            noise_std=None if table.noise_std is None else table.noise_std * factor,
            zero_std=None if table.zero_std is None else table.zero_std * factor,
            jitter_std=table.jitter_std,
            clock=table.clock or reference,
            **table.located,
            channels=() if table.areas else table.channels,
            file=table.file,
            time_column=table.time or table.frequency or "",
        )

    def _unit(self, table: SignalTable) -> tuple[str, float]:
        """Return the SI unit of the values and the factor to it."""
        if table.input is None:
            return table.si
        return response_unit(table, next(s for s in self.table.signals if s.name == table.input))

    def _frequency(self, table: SignalTable) -> Floats:
        """Return frequencies [Hz]; they must rise."""
        assert table.frequency is not None
        self._check_range(table.file, table.frequency, "Hz", 1.0)
        found = self._column(table.file, table.frequency)
        csv, steps = self._files[table.file], np.diff(found, prepend=-1e-300)
        wrong = np.flatnonzero(~(steps > 0) | ~(found >= 0))
        if len(wrong):
            row = int(wrong[0])
            what = f"frequencies must be at least 0 and rise, got {found[row]:.9g}"
            raise InvalidFile(csv.file, f"line {csv.line(row)}, column {table.frequency}", what)
        return found

    def _check_columns(self, i: int, table: SignalTable) -> None:
        """Open the file of a signal and look for its columns."""
        if table.file not in self._files:
            path = self.toml.parent / table.file
            if not (self.outside or is_inside(path, self.toml.parent)):
                what = f"{table.file!r} lies outside the record's directory; --allow-outside reads it"
                raise self._error(i, table, "file", what)
            if not _exists(path):
                others = ", ".join(sorted(p.name for p in self.toml.parent.glob("*.csv")))
                what = f"there is no file {table.file!r}; there are {others or 'none'}"
                raise self._error(i, table, "file", what)
            self._files[table.file] = CsvFile(path)
        header = self._files[table.file].header
        stamp = STAMPS[self.table.kind]
        more = () if table.coherence is None else (table.coherence,)
        named = {stamp: (getattr(table, stamp),), "channels": table.channels, "coherence": more}
        for key, columns in named.items():
            for column in columns:
                if column not in header:
                    raise self._error(
                        i,
                        table,
                        key,
                        missing("column", column, header) + f" in {table.file}{_separated(header)}",
                    )

    def _error(self, i: int, table: SignalTable, key: str, what: str) -> InvalidFile:
        line = line_in(self.text, ("signals", i, key))
        return InvalidFile(self.toml, f"signals.{table.name}.{key}", what, line=line)

    def _column(self, file: str, name: str) -> Floats:
        """Return a column of numbers; the first call reads all that the record needs from the file."""
        if file not in self._columns:
            users = [s for s in self.table.signals if s.file == file and not is_input(self.table, s)]
            header = self._files[file].header
            wanted = dict.fromkeys(
                c for s in users for c in (s.time, s.frequency, s.coherence, *s.channels) if c in header
            )
            names = [name for name in wanted if name is not None]
            self._columns[file] = dict(zip(names, self._files[file].numbers(names).T, strict=True))
        return self._columns[file][name]

    def _check_range(self, file: str, column: str, unit: str, factor: float) -> None:
        """Refuse a column with a value that is out of the physical range of its unit."""
        values = self._column(file, column)
        if at := first_beyond(values, unit, factor):
            most = range_of(unit)[1] / factor
            csv = self._files[file]
            where = f"line {csv.line(at[0])}, column {column}"
            raise InvalidFile(csv.file, where, f"must lie within +-{most:g}, got {values[at]:.9g}")

    def _time(self, table: SignalTable) -> Floats:
        """Return stamps [s]; they must rise."""
        assert table.time is not None
        key = (table.file, table.time, table.time_unit)
        if key not in self._times:
            _, factor = si_factor(table.time_unit, ("s",))
            self._check_range(table.file, table.time, "s", factor)
            stamps = self._column(table.file, table.time)
            self._check_rising(table, stamps, factor)
            self._times[key] = stamps * factor
        return self._times[key]

    def _check_rising(self, table: SignalTable, stamps: Floats, factor: float) -> None:
        csv = self._files[table.file]
        empty = np.flatnonzero(np.isnan(stamps))
        if len(empty):
            what = f"line {csv.line(int(empty[0]))}, column {table.time}"
            raise InvalidFile(csv.file, what, "a row needs a time, got none")
        falls = np.flatnonzero(np.diff(stamps) < range_of("s")[0] / factor)
        if len(falls):
            row = int(falls[0]) + 1
            rise = stamps[row] - stamps[row - 1]
            kind = "repeats" if rise == 0 else "goes back behind" if rise < 0 else "all but repeats"
            texts = csv.texts(table.time or "")  # as they stand there: a number may have fewer digits
            what = f"{texts[row]} {kind} {texts[row - 1]} of line {csv.line(row - 1)}; times must rise"
            raise InvalidFile(csv.file, f"line {csv.line(row)}, column {table.time}", what)

    def _pose(self, table: SignalTable) -> NDArray[np.str_]:
        assert table.pose is not None
        csv = self._files[table.file]
        poses = csv.texts(table.pose)
        if "" in poses:
            what = f"line {csv.line(poses.index(''))}, column {table.pose}"
            raise InvalidFile(csv.file, what, "a row needs a pose, got none")
        return np.array([canonical_pose(pose) for pose in poses])

    def _compare_suffix(self, table: SignalTable) -> None:
        """Columns are often named after their unit; a name that says another one is worth a word."""
        for column, unit in [
            *((name, table.unit or table.si[0]) for name in table.channels if table.input is None),
            (table.time or "", table.time_unit),
        ]:
            if what := contradicted_unit(column, unit):
                self.notes.append(Problem(f"signals.{table.name}", what))


def _separated(header: Sequence[str]) -> str:
    """Return a word on the separator, if a header is a single column that looks like several."""
    found = next((mark for mark in ";\t|" if len(header) == 1 and mark in header[0]), None)
    return f"; cells are separated by commas, these look separated by {found!r}" if found else ""


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except (OSError, ValueError):  # a name that is too long for the file system, or holds a null byte
        return False
