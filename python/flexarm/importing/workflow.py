"""From an import map to a record: each signal in SI, on its own instants."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np

from flexarm.arguments import takes
from flexarm.arm import Arm
from flexarm.arm.joint import motor_ratio
from flexarm.arm.rotation import from_rpy
from flexarm.arrays import Floats
from flexarm.errors import InvalidFile, InvalidParameter, Problem
from flexarm.importing.formats import opened
from flexarm.importing.frequency_response import check_frequencies, response_of
from flexarm.importing.map_file import Dialect, Every, MapTable, SignalMap, read_map
from flexarm.importing.source import Array, Request, Samples, Source, Unreadable
from flexarm.importing.stamps import Stamps, as_date, origins, stamps_of
from flexarm.reading import reading
from flexarm.record.compatibility import unknown_names
from flexarm.record.record import Record
from flexarm.record.signal import Signal, canonical_pose
from flexarm.record.table import Clock
from flexarm.tables import refuse
from flexarm.tables.field import Path as Where
from flexarm.units import contradicted_unit


@takes()
def import_record(path: str | Path) -> Record:
    """Return the record that an import map makes of logs.

    Parameters
    ----------
    path : str or Path
        The map, a TOML file; its sources are found from where it lies.

    Returns
    -------
    Record
        In SI. Every signal keeps its own instants; stamps that count from 1970 are shifted by a whole number
        of seconds, which the record's `notes` tell.

    Raises
    ------
    InvalidFile
        With everything that is wrong in the map and in its sources, each with its place.

    Examples
    --------
    >>> import_record("run7.map.toml").save("run7")  # doctest: +SKIP
    """
    file = Path(path)
    table, data, text = read_map(file)
    importer = _Importer(file, table)
    record = importer.record()
    refuse(importer.found, data, file, text)
    assert record is not None
    return record


def sources_of(path: Path) -> list[Path]:
    """Return the files that a map reads, with the map itself."""
    table, _, _ = read_map(path)
    names = [signal.source for signal in table.signals] + ([table.model] if table.model else [])
    return [path, *(path.parent / name for name in dict.fromkeys(names))]


@dataclass
class _Importer:
    """Reads the signals of one map, and keeps what is wrong."""

    file: Path
    table: MapTable
    found: list[tuple[Where, str]] = field(default_factory=list)

    def record(self) -> Record | None:
        """Return the record, or None if something is wrong."""
        arm = self._arm()
        sources = self._sources()
        clocks = dict(self.table.clocks) or {"clock": Clock()}
        read: dict[int, tuple[Samples, Stamps]] = {}
        for i, signal in enumerate(self.table.signals):
            if signal.bare:
                read[i] = (
                    Samples(np.empty((0, signal.spec.channels or len(signal.axes)))),
                    Stamps(np.array([]), 1.0),
                )
                continue
            with self._blamed(i):
                if (source := sources.get((signal.source, signal.csv))) is not None:
                    read[i] = self._read(signal, source)
        if self.found:
            return None
        by_clock: dict[str, list[Stamps]] = {}
        for i, (_, stamps) in read.items():
            clock = self.table.signals[i].clock or next(iter(clocks))
            others = by_clock.setdefault(clock, [])
            if len(others) and len(stamps.raw) and others[0].of_calendar != stamps.of_calendar:
                start, first = stamps.start, others[0].start
                what = f"{clock!r} begins at {start:.10g} s here and at {first:.10g} s in signals before; "
                self.found.append((("signals", i, "clock"), f"{what}one counts from 1970: it needs a clock"))
            others.append(stamps)
        origin = origins(by_clock, clocks)
        signals = []
        for i, (samples, stamps) in read.items():
            with self._blamed(i):
                signals.append(self._signal(self.table.signals[i], samples, stamps, arm, origin))
        if self.found:
            return None
        notes = [
            Problem(f"clocks.{name}", f"stamps count from {as_date(second)}, {second} s after 1970")
            for name, second in origin.items()
            if second
        ]
        notes += [
            note
            for i, (samples, _) in read.items()
            for note in _contradictions(self.table.signals[i], samples, arm)
        ]
        by_name = {signal.name: signal for signal in signals}
        return Record(**{**self.table.stated(), "signals": by_name, "clocks": clocks, "notes": tuple(notes)})

    @contextmanager
    def _blamed(self, index: int) -> Iterator[None]:
        """Keep errors as problems of a signal, with the key that asked for what failed."""
        place: Where = ("signals", index)
        source = self.table.signals[index].source
        try:
            yield
        except Unreadable as error:
            self.found.append(((*place, error.key), f"{source}: {error.what}"))
        except InvalidFile as error:
            where = error.problems[0].where
            key = where if where.startswith("csv") else "source"
            self.found += [((*place, key), f"{error.file}: {problem}") for problem in error.problems]
        except InvalidParameter as error:
            start = f"signals.{self.table.signals[index].name}."
            self.found += [
                (place, f"{source}: {problem.where.removeprefix(start)}: {problem.what}")
                for problem in error.problems
            ]

    def _arm(self) -> Arm | None:
        """Return the model; names that it has not become problems."""
        if self.table.model is None:
            return None
        try:
            arm = Arm.from_toml(self.file.parent / self.table.model)
        except InvalidFile as error:
            self.found += [(("model",), f"{error.file}: {problem}") for problem in error.problems]
            return None
        t = self.table
        index = {signal.name: i for i, signal in enumerate(t.signals)}
        named = SimpleNamespace(
            signals={signal.name: signal for signal in t.signals},
            joints=t.joints,
            payloads=t.payloads,
            links=t.links,
            controllers=t.controllers,
        )
        for problem in unknown_names(cast(Any, named), arm):
            table, name, *key = problem.where.split(".")
            where: Where = (table, index[name], *key) if table == "signals" else (table, name)
            self.found.append((where, problem.what))
        return arm

    def _sources(self) -> dict[tuple[str, Dialect], Source]:
        """Return a reader for each file, which knows all that is asked of it."""
        asked: dict[tuple[str, Dialect], list[int]] = {}
        for i, signal in enumerate(self.table.signals):
            if signal.bare:
                continue
            asked.setdefault((signal.source, signal.csv), []).append(i)
        found = {}
        for (name, dialect), signals in asked.items():
            with self._blamed(signals[0]):
                path = self.file.parent / name
                requests = [request_of(self.table.signals[i]) for i in signals]
                with reading(path, "a log"):
                    found[name, dialect] = opened(path, dialect, requests)
        return found

    def _read(self, signal: SignalMap, source: Source) -> tuple[Samples, Stamps]:
        """Return samples of the rows that a signal takes, and their stamps."""
        request = request_of(signal)
        with reading(source.path, "a log"):
            try:
                samples = source.read(request)
            except Unreadable as error:
                kept: Unreadable | None = error
            else:
                kept = None
        if kept is not None:
            raise kept
        rows = _chosen(signal, samples)
        taken = Samples(
            samples.values[rows],
            None if samples.time is None else samples.time[rows],
            samples.time_unit,
            tuple(column[rows] for column in samples.others),
        )
        if not len(taken.values):
            raise Unreadable("where" if signal.where else "columns", _no_row(signal, samples))

        def place(row: int) -> str:
            return source.place(signal.topic, int(rows[row]) if isinstance(rows, np.ndarray) else row)

        if signal.pose is not None and "" in (poses := _poses(taken.others[0])):
            row = int(np.flatnonzero(poses == "")[0])
            raise Unreadable("pose", f"{place(row)}: a row needs a pose, got none")
        if self.table.kind == "frequency_response":
            check_frequencies(taken.others[0], place)
        if self.table.kind != "motion":
            return taken, Stamps(np.array([]), 1.0)
        return taken, stamps_of(signal, taken, place)

    def _signal(
        self, table: SignalMap, samples: Samples, stamps: Stamps, arm: Arm | None, origin: dict[str, int]
    ) -> Signal:
        """Return one signal in SI units."""
        static = self.table.kind == "static"
        pose = None
        if static and table.pose is not None:
            pose = _poses(samples.others[0])
        elif static:
            pose = np.array([str(row + 1) for row in range(len(samples.values))])
        clock = table.clock or next(iter(origin), "")
        if self.table.kind == "frequency_response":
            return response_of(table, samples, self.table.signals, clock)
        return Signal(
            name=table.name,
            quantity=table.quantity,
            values=_in_si(table, samples.values, arm),
            unit=_si_unit(table, arm),
            time=None if static else stamps.seconds(origin[clock]),  # type: ignore[arg-type]
            pose=pose,
            noise_std=table.noise_std,
            jitter_std=table.jitter_std,
            clock="" if static else clock,
            **table.located,
            file=f"{Path(table.source).stem}.csv",
        )


def _contradictions(table: SignalMap, samples: Samples, arm: Arm | None) -> Iterator[Problem]:
    """Yield columns whose names end in another unit than the one read; a scale may convert units."""
    unit = _si_unit(table, arm) if table.unit is None else table.unit
    read = isinstance(unit, str) and table.scale == (1.0,) and table.input is None
    columns = [(each, str(unit)) for each in table.columns if isinstance(each, str) and read]
    if isinstance(table.time, str) and table.time_unit is not None and samples.time_unit is None:
        columns.append((table.time, table.time_unit))
    for column, stated in columns:
        if what := contradicted_unit(column, stated):
            yield Problem(f"signals.{table.name}", what)


def request_of(signal: SignalMap) -> Request:
    """Return what a signal asks of its source."""
    others: list[tuple[str, str | int]] = [] if signal.pose is None else [("pose", signal.pose)]
    others += [
        (key, column)
        for key, column in (("frequency", signal.frequency), ("coherence", signal.coherence))
        if column is not None
    ]
    others += [("where", int(column) if column.isdigit() else column) for column in signal.where]
    return Request(
        signal.topic,
        signal.columns,
        None if isinstance(signal.time, Every) else signal.time,
        tuple(others),
        signal.time_format is not None,
        signal.time_unit,
    )


def _poses(column: Array) -> Array:
    """Return the names of poses on one line each; empty where a row has none."""
    texts = ["" if value is None or value != value else str(value) for value in column.tolist()]
    return np.array([canonical_pose(" ".join(text.split())) for text in texts])


def _chosen(signal: SignalMap, samples: Samples) -> Array | slice:
    """Return the rows that a signal takes."""
    if not signal.where:
        return slice(None)
    chosen = np.ones(len(samples.values), dtype=bool)
    for wanted, column in zip(signal.where.values(), _labels(signal, samples), strict=True):
        if isinstance(wanted, str):
            form = re.compile(re.escape(wanted).replace(r"\*", ".*").replace(r"\?", "."), re.S)
            chosen &= np.array([bool(form.fullmatch(str(value).strip())) for value in column.tolist()])
        else:
            chosen &= column.astype(float) == wanted if column.dtype.kind in "iufb" else False
    return np.flatnonzero(chosen)


def _labels(signal: SignalMap, samples: Samples) -> tuple[Array, ...]:
    """Return the columns by which rows are chosen."""
    return samples.others[-len(signal.where) :]


def _no_row(signal: SignalMap, samples: Samples) -> str:
    """Say that there is no row, and what the columns hold by which rows are chosen."""
    most_named = 5  # values of a column that an error names
    if not signal.where or not len(samples.values):
        return "there is no row"
    found = []
    for (column, wanted), values in zip(signal.where.items(), _labels(signal, samples), strict=True):
        names = list(
            dict.fromkeys(
                f"{str(v).strip()!r}" if isinstance(wanted, str) else f"{v}" for v in values.tolist()
            )
        )
        more = f" and {len(names) - most_named} more" if len(names) > most_named else ""
        found.append(f"column {column!r} holds {', '.join(names[:most_named])}{more}")
    return f"there is no row with {signal.where}; {'; '.join(found)}"


def _si_unit(table: SignalMap, arm: Arm | None) -> str:
    """Return the SI unit of a signal's values.

    A joint that slides has metres and newtons where the map says none, and behind a gear, in rad/m.
    """
    stated = table.unit is not None and not table.before_gear
    if arm is None or table.joint is None or stated or arm.joint(table.joint).type != "prismatic":
        return table.si[0]
    return table.spec.units[-1]


def _quaternions(values: Floats, form: str) -> Floats:
    """Return quaternions x, y, z, w of a form of rotations, angles in rad; NaN where a row holds none."""
    from scipy.spatial.transform import Rotation

    found = np.full((len(values), 4), np.nan)
    sound = np.flatnonzero(np.isfinite(values).all(axis=1))
    if form == "matrix":
        matrices = values.reshape(-1, 3, 3)
        sound = sound[np.linalg.det(matrices[sound]) > 0]
        found[sound] = Rotation.from_matrix(matrices[sound]).as_quat()
    elif form == "vector":
        found[sound] = Rotation.from_rotvec(values[sound]).as_quat()
    else:
        found[sound] = Rotation.from_euler(form, values[sound]).as_quat()
    return found


def _in_si(table: SignalMap, values: Floats, arm: Arm | None) -> Floats:
    """Return values in SI: by the gear, then scale x value + offset in the unit, then to SI."""
    if table.before_gear and arm is not None and table.joint is not None:
        ratio = motor_ratio(arm, table.joint)
        values = values * ratio if table.quantity == "motor_torque" else values / ratio
    if table.scale != (1.0,):
        values = values * np.array(table.scale)
    if table.offset != (0.0,):
        values = values + np.array(table.offset)
    if table.sum:
        values = values.sum(axis=1, keepdims=True)
    if (factor := table.si[1]) != 1.0:
        values = values * factor
    if table.rotation != "quaternion":
        values = _quaternions(values, table.rotation)
    elif table.quaternion == "wxyz":
        values = values[:, [1, 2, 3, 0]]
    if table.mount is not None:
        values = (values @ np.array(from_rpy(table.mount)).T)[:, ["xyz".index(axis) for axis in table.axes]]
    return values
