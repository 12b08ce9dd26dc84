"""From a record to a directory: `record.toml` and one CSV file for each set of instants."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter
from flexarm.output import output_file, write_file
from flexarm.record.signal import Signal
from flexarm.tables import toml_text
from flexarm.units import contradicted_unit

if TYPE_CHECKING:
    from flexarm.record.record import Record

BLOCK = 1 << 18
"""Rows that are written at once."""
_UNIT_SUFFIX = {
    "m": "m",
    "rad": "rad",
    "rad/s": "rad_s",
    "m/s": "m_s",
    "m/s2": "m_s2",
    "N m": "Nm",
    "N": "N",
    "V": "V",
    "kg": "kg",
}


def write(record: Record, directory: Path) -> None:
    """Write `record.toml` and the CSV files into a directory."""
    placed = [_place(signal) for signal in record.signals.values()]
    files = _share_out([signal for signal in placed if not _is_bare(signal)])
    tables = [_signal_table(signal, "") for signal in placed if _is_bare(signal)]
    for file, signals in files.items():
        _write_csv(directory / file, signals)
        tables += [_signal_table(signal, file) for signal in signals]
    order = {name: i for i, name in enumerate(record.signals)}
    tables.sort(key=lambda table: order[table["name"]])
    write_file(directory / "record.toml", toml_text(_record_table(record, tables)))


def _is_bare(signal: Signal) -> bool:
    """Return True for the input of a frequency response, which has no values."""
    return signal.frequency is not None and not signal.input


def _place(signal: Signal) -> Signal:
    """Return the signal with a file and names for its columns, where it has none."""
    if _is_bare(signal):
        return signal
    suffix = _UNIT_SUFFIX.get(signal.unit)
    directions = signal.axes if signal.spec.channels is None else ()
    directions = ("x", "y", "z", "w") if signal.quantity == "orientation" else directions
    names = [f"{signal.name}_{d}" for d in directions] or [signal.name]
    made = tuple(f"{name}_{suffix}" if suffix else name for name in names)
    if signal.input:
        made = tuple(f"{name}_{part}" for name in names for part in ("real", "imaginary"))
    contradicted = any(contradicted_unit(name, signal.unit) for name in signal.channels)
    channels = made if contradicted or not signal.channels else signal.channels
    stamps = signal.time_column or "time_s"
    stamps = "time_s" if contradicted_unit(stamps, "s") else stamps
    stamps = "pose" if signal.pose is not None and stamps == "time_s" else stamps
    stamps = "hz" if signal.frequency is not None and stamps == "time_s" else stamps
    plain = Path(signal.file).name if signal.file else f"{signal.name}.csv"
    return signal.replace(channels=channels, file=plain, time_column=stamps)


def _share_out(signals: list[Signal]) -> dict[str, list[Signal]]:
    """Return signals by file; those of one file share its instants and have different columns."""
    files: dict[str, list[Signal]] = {}
    for signal in signals:
        file = signal.file
        number = 1
        while file in files and not _can_join(files[file], signal):
            again = f"-{number}" if number > 1 else ""
            file = f"{Path(signal.file).stem}-{signal.name}{again}.csv"
            number += 1
        files.setdefault(file, []).append(signal)
    return files


def _can_join(others: list[Signal], signal: Signal) -> bool:
    first = others[0]
    taken = {channel for other in others for channel in other.channels}
    same_stamps = np.array_equal(_stamps(first), _stamps(signal)) and first.time_column == signal.time_column
    return same_stamps and not taken & set(signal.channels)


def _stamps(signal: Signal) -> Any:
    stamps = signal.time if signal.frequency is None else signal.frequency
    return stamps if signal.pose is None else signal.pose


def _coherence_column(signal: Signal) -> str:
    return f"{signal.name}_coherence"


def _columns(signal: Signal) -> list[tuple[str, Floats]]:
    """Return the columns of a signal with their names."""
    found = list(zip(signal.channels, signal.values.T, strict=True))
    return found if signal.coherence is None else [*found, (_coherence_column(signal), signal.coherence)]


def _write_csv(path: Path, signals: list[Signal]) -> None:
    """Numbers in the shortest form that reads back exactly; drop-outs as empty cells."""
    first = signals[0]
    names = [name for signal in signals for name, _ in _columns(signal)]
    header = ",".join(map(_text_cell, [first.time_column, *names]))
    blocks = [slice(start, start + BLOCK) for start in range(0, len(first), BLOCK)]
    with output_file(path) as partial, partial.open("wb") as file:
        file.write(f"{header}\n".encode())
        if len(blocks) > 1 and first.pose is None and find_spec("pyarrow"):
            with ThreadPoolExecutor(os.cpu_count()) as pool:
                for text in pool.map(lambda rows: _by_arrow(signals, rows), blocks):
                    file.write(text)
            return
        for rows in blocks:
            file.write(_by_python(signals, rows))


def _by_python(signals: list[Signal], rows: slice) -> bytes:
    """Return rows as text."""
    first = signals[0]
    stamps = _stamps(first)[rows].tolist()
    columns = [list(map(repr if first.pose is None else _pose_cell, stamps))]
    columns += [_cells(column[rows]) for signal in signals for _, column in _columns(signal)]
    return ("\n".join(map(",".join, zip(*columns, strict=True))) + "\n").encode()


def _by_arrow(signals: list[Signal], rows: slice) -> memoryview:
    """Return the same by Arrow, which takes a tenth of the time and lets others run beside it."""
    pa, csv = import_module("pyarrow"), import_module("pyarrow.csv")
    own = (column[rows] for signal in signals for _, column in _columns(signal))
    columns = [_stamps(signals[0])[rows], *own]
    arrays = [pa.array(np.ascontiguousarray(column), from_pandas=True) for column in columns]
    table = pa.table(arrays, names=[str(number) for number in range(len(arrays))])
    sink = pa.BufferOutputStream()
    csv.write_csv(table, sink, csv.WriteOptions(include_header=False))
    return memoryview(sink.getvalue())


def _pose_cell(pose: str) -> str:
    return _text_cell(" ".join(pose.split()))


def _text_cell(text: str) -> str:
    """Return a name as a cell, in quotes where it would read as several cells or as a comment.

    Raise InvalidParameter if it does not read back at all.
    """
    if not text or text != text.strip() or len(text.splitlines()) > 1:
        what = "names of poses and columns are texts on one line, without blanks around"
        raise InvalidParameter(f"{what}, got {text!r}")
    return '"' + text.replace('"', '""') + '"' if any(mark in text for mark in '#",') else text


def _cells(column: Floats) -> list[str]:
    cells = list(map(repr, column.tolist()))
    for i in np.flatnonzero(np.isnan(column)):
        cells[i] = ""
    return cells


def _record_table(record: Record, signals: list[dict[str, Any]]) -> dict[str, Any]:
    table: dict[str, Any] = {"format": "flexarm-record/1"}
    for name, default in (("description", ""), ("kind", "motion"), ("initial", "equilibrium")):
        if getattr(record, name) != default:
            table[name] = getattr(record, name)
    if record.drive:
        table["drive"] = record.drive[0] if len(record.drive) == 1 else list(record.drive)
    table["joints"] = dict(record.joints)
    table["payloads"] = {name: load.to_plain() for name, load in record.payloads.items()}
    table["controllers"] = {name: dict(values) for name, values in record.controllers.items()}
    table["links"] = {name: drawn.to_plain() for name, drawn in record.links.items()}
    table["clocks"] = {name: _clock(clock.to_plain()) for name, clock in record.clocks.items()}
    frames = {name: frame.to_plain() for name, frame in record.frames.items()}
    unknown = {"unknown": True}
    table["frames"] = {name: "unknown" if each == unknown else each for name, each in frames.items()}
    table["base"] = {} if record.base is None else record.base.to_plain()
    return {**{key: value for key, value in table.items() if value or key == "format"}, "signals": signals}


def _clock(plain: dict[str, Any]) -> Any:
    if plain.get("unknown"):
        return "unknown" if len(plain) == 1 else plain
    return plain if "offset" in plain else plain.get("sigma", 0.0)


def _signal_table(signal: Signal, file: str) -> dict[str, Any]:
    """Return the signal's table; keys that say nothing are left out."""
    where = {key: getattr(signal, key) for key in ("joint", "point", "link", "payload", "side")}
    stamp = "time" if signal.pose is None else "pose"
    stamp = stamp if signal.frequency is None else "frequency"
    axes = {"axes": list(signal.axes)} if signal.axes else {}
    rest = {
        "position": signal.position,
        "fibre": list(signal.fibre) if signal.fibre else None,
        "frame": None if signal.frame == "base" else signal.frame,
        "input": signal.input or None,
        "file": file or None,
        stamp: signal.time_column if file else None,
        "channels": list(signal.channels) if file else None,
        "coherence": None if signal.coherence is None else _coherence_column(signal),
        "averages": None if signal.averages == 1 else signal.averages,
        "unit": signal.unit,
        "noise_std": signal.noise_std,
        "zero_std": signal.zero_std,
        "jitter_std": signal.jitter_std or None,
        "clock": signal.clock,
    }
    table = {"name": signal.name, "quantity": signal.quantity, **where, **axes, **rest}
    return {key: value for key, value in table.items() if value is not None}
